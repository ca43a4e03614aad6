#include "trilobe/app/result_folder.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <random>
#include <utility>

#include "trilobe/base/error.h"
#include "trilobe/io/file.h"
#include "trilobe/io/source.h"

namespace trilobe {
namespace {

std::string RandomDigits() {
  std::random_device random;
  std::array<char, 17> digits;
  std::snprintf(digits.data(), digits.size(), "%08x%08x", random(), random());
  return digits.data();
}

}  // namespace

Inputs::Inputs(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    struct stat status {};
    if (IsSynthetic(path) || stat(path.c_str(), &status) != 0) continue;
    name_of_.emplace(std::pair(status.st_dev, status.st_ino), path);
  }
}

void Inputs::CheckOutput(const std::string& path) const {
  struct stat status {};
  if (stat(path.c_str(), &status) == 0) {
    const auto input = name_of_.find({status.st_dev, status.st_ino});
    if (input != name_of_.end()) {
      throw Error("writing '" + path + "' would destroy '" + input->second +
                  "', which this command reads; give another --out");
    }
  }
  CheckWritable(path);
}

ResultFolder::ResultFolder(std::string path, std::vector<std::string> names, const Inputs& inputs)
    : path_(std::move(path)), names_(std::move(names)), run_(RandomDigits()) {
  std::error_code ignored;
  if (std::filesystem::exists(path_, ignored) && !std::filesystem::is_directory(path_, ignored)) {
    throw Error("cannot write into '" + path_ + "': it is not a folder; give another --out");
  }
  for (const std::string& name : names_) inputs.CheckOutput(PathOf(name));
}

void ResultFolder::Open() const {
  MakeDirectories(path_);
  SweepTemporaryFiles(path_);
}

void ResultFolder::Write(const std::string& name, const std::function<void(std::ostream&)>& write) {
  WriteFile(PathOf(name), write, [&] {
    if (!begun_) RemoveEarlierRun(name);
  });
  begun_ = true;
}

std::vector<std::string> ResultFolder::Files() const {
  std::vector<std::string> files;
  std::ranges::copy_if(names_, std::back_inserter(files), [this](const std::string& name) {
    std::error_code ignored;
    return std::filesystem::exists(PathOf(name), ignored);
  });
  return files;
}

void ResultFolder::RemoveEarlierRun(const std::string& except) const {
  for (const std::string& name : names_) {
    std::error_code error;
    if (name == except) continue;
    std::filesystem::remove(PathOf(name), error);
    if (error) {
      throw Error("cannot remove '" + PathOf(name) + "' of an earlier run: " + error.message());
    }
  }
}

}  // namespace trilobe
