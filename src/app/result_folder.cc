#include "app/result_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

#include "app/own_files.h"
#include "core/files/file.h"
#include "core/system/content_hash.h"
#include "fit/reports/fit_report.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/io/formats/source.h"

namespace trilobe {
namespace {

namespace fs = std::filesystem;

}  // namespace

Inputs::Inputs(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    struct stat status {};
    if (IsSynthetic(path) || stat(path.c_str(), &status) != 0) continue;
    name_of_.emplace(std::pair(status.st_dev, status.st_ino), path);
  }
}

void Inputs::CheckNotRead(const std::string& path) const {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) return;
  const auto input = name_of_.find({status.st_dev, status.st_ino});
  if (input == name_of_.end()) return;
  throw Error(ErrorKind::kFile, "writing '" + path + "' would destroy '" + input->second +
                                    "', which this command reads; give another --out")
      .At(path)
      .About("replace", input->second);
}

void Inputs::CheckOutput(const std::string& path, const MayReplace& may_replace) const {
  CheckNotRead(path);
  CheckWritable(path);
  may_replace(path);
  std::error_code ignored;
  SweepTemporaryFiles(fs::absolute(path, ignored).parent_path());
}

std::string PreviousName(const std::string& name) {
  const fs::path path(name);
  return path.stem().string() + ".previous" + path.extension().string();
}

ResultFolder::ResultFolder(std::string path, std::vector<std::string> names, const Inputs& inputs)
    : path_(std::move(path)), names_(std::move(names)), run_(RandomDigits()) {
  std::error_code ignored;
  if (fs::exists(path_, ignored) && !fs::is_directory(path_, ignored)) {
    throw Error(ErrorKind::kFile,
                "cannot write into '" + path_ + "': it is not a folder; give another --out")
        .At(path_)
        .About("write");
  }
  for (const std::string& name : names_) {
    inputs.CheckNotRead(PathOf(name));
    inputs.CheckNotRead(PathOf(PreviousName(name)));
    CheckWritable(PathOf(name));
    CheckMayReplace(PathOf(name));
  }
}

void ResultFolder::Open() const {
  MakeDirectories(path_);
  CheckWritable(PathOf(names_.front()));  // its permissions may be no better than `umask`
  SweepTemporaryFiles(path_);
}

void ResultFolder::KeepEarlier(const std::string& name) {
  CheckWritable(PathOf(PreviousName(name)));
  CheckMayReplace(PathOf(PreviousName(name)));
  kept_.push_back(name);
}

void ResultFolder::WriteAhead(const std::string& name,
                              const std::function<void(std::ostream&)>& write) {
  WriteFile(PathOf(name), write);
  ahead_.push_back(name);
}

void ResultFolder::Write(const std::string& name, const std::function<void(std::ostream&)>& write) {
  if (begun_) {
    WriteFile(PathOf(name), write);
    return;
  }
  ahead_.push_back(name);
  WriteFile(PathOf(name), write, [&](std::string_view) { RemoveEarlierRun(); });
  begun_ = true;
}

void ResultFolder::KeepChecksum(const std::string& name, std::string_view content) {
  checksums_[name] = ContentHash(content);
  const nlohmann::ordered_json record = {
      {"format", kReportFormat}, {"unfinished", true}, {"run", run_}, {kChecksumsKey, checksums_}};
  WriteFile(PathOf(names_.front()), [&](std::ostream& out) { out << record.dump(2) << "\n"; });
}

std::vector<std::string> ResultFolder::Files() const {
  std::vector<std::string> files;
  std::ranges::copy_if(names_, std::back_inserter(files), [this](const std::string& name) {
    std::error_code ignored;
    return fs::exists(PathOf(name), ignored);
  });
  return files;
}

bool TellMissingPictures(const std::string& why, const std::string& folder) {
  constexpr std::uintmax_t kLeast = 1 << 18;  // bytes, as much as a picture takes
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  const bool is_full = !error && space.available < kLeast;
  std::cerr << "trilobe: pictures are missing: "
            << (is_full ? "the disk of '" + Printable(folder) +
                              "' is full; free some space and type the same command again"
                        : Printable(why))
            << "\n";
  return is_full;
}

// The file that says that a run is complete goes first.
void ResultFolder::RemoveEarlierRun() const {
  for (const std::string& name : names_) {
    std::error_code error;
    if (std::ranges::find(kept_, name) != kept_.end()) {
      fs::rename(PathOf(name), PathOf(PreviousName(name)), error);
      if (!error) continue;
      throw Error(ErrorKind::kFile,
                  "cannot rename '" + PathOf(name) + "' of an earlier run: " + error.message())
          .At(PathOf(name))
          .About("rename", error.message());
    }
    if (std::ranges::find(ahead_, name) != ahead_.end()) continue;
    fs::remove(PathOf(name), error);
    if (error) {
      throw Error(ErrorKind::kFile,
                  "cannot remove '" + PathOf(name) + "' of an earlier run: " + error.message())
          .At(PathOf(name))
          .About("remove", error.message());
    }
  }
}

}  // namespace trilobe
