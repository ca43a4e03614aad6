#include "app/own_files.h"

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/flags.h"
#include "core/files/file.h"
#include "core/files/own_mark.h"
#include "core/system/content_hash.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"

namespace trilobe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Whether the file is of the kind that its name says: a picture or a measurement.
bool IsOfItsKind(const std::string& path, const std::string& content) {
  const std::string ending = EndingOf(path);
  if (ending == ".png") return content.starts_with("\x89PNG");
  const MeasurementFormat* const format = RecogniseFormat(content);
  return format != nullptr && format->ending == ending;
}

// Whether a report or a plan beside a file has its checksum; or, of an earlier version that kept
// none, its name.
bool IsInRecord(const std::string& path, const std::string& content) {
  const fs::path file(path);
  for (const char* const name : {"report.json", "plan.json"}) {
    std::string text;
    try {
      text = ReadFile(file.parent_path() / name);
    } catch (const Error&) {
      continue;  // none
    }
    if (!SaysOwn(text)) continue;
    const Json record = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    const std::string own = file.filename();
    if (const auto sums = record.find(kChecksumsKey); sums != record.end()) {
      if (sums->is_object() && sums->value(own, Json()) == ContentHash(content)) return true;
    } else if (const auto files = record.find("files"); files != record.end()) {
      if (std::ranges::find(*files, Json(own)) != files->end()) return IsOfItsKind(path, content);
    }
  }
  return false;
}

// Whether --force lets it be replaced, or its content.
bool IsFree(const std::string& path) {
  std::error_code ignored;
  if (FLAGS_force || !fs::is_regular_file(path, ignored)) return true;
  try {
    const std::string content = ReadFile(path);
    return content.empty() || SaysOwn(content) || IsInRecord(path, content);
  } catch (const Error&) {
    return false;  // it cannot be read
  }
}

// Whether it is a measurement of a format that has no room for a mark.
bool CannotSay(const std::string& path) {
  const std::string ending = EndingOf(path);
  const MeasurementFormat* const format =
      fs::is_regular_file(path) ? RecogniseFormat(ReadFile(path)) : nullptr;
  return format != nullptr && !format->is_text && format->write != nullptr &&
         (ending == format->ending || ending.empty());
}

[[noreturn]] void Refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorKind::kFile,
              "'" + path + "' exists, and " + why +
                  "; move it away, give another --out, or overwrite it by --force")
      .At(path)
      .About("replace");
}

}  // namespace

void CheckMayReplace(const std::string& path) {
  if (!IsFree(path)) Refuse(path, "Trilobe has not written it");
}

void CheckMayReplaceMeasurement(const std::string& path) {
  if (!IsFree(path) && !CannotSay(path)) Refuse(path, "Trilobe has not written it");
}

std::string ReplaceMeasurement(const Measurement& measurement, const std::string& path,
                               int num_threads) {
  const bool free = IsFree(path);
  return WriteMeasurement(measurement, path, num_threads, [&](std::string_view content) {
    if (free || ReadFile(path) == content) return;
    Refuse(path, "cannot say who wrote it, and would become another");
  });
}

}  // namespace trilobe
