#include "app/study_record.h"

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <system_error>

#include "app/fit_run.h"
#include "app/program.h"
#include "core/base/json_text.h"
#include "core/files/json_value.h"
#include "core/files/own_mark.h"
#include "core/system/content_hash.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/io/formats/source.h"

namespace trilobe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

bool Exists(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

// The settings that a run depends on. The content of its measurement and the program are none: a
// study that goes on after these have changed is the same.
std::string SettingsOf(const StudyJob& job) {
  const std::string& source = job.outcome.source;
  std::error_code ignored;
  const std::string place =
      IsSynthetic(source) ? source : fs::weakly_canonical(source, ignored).string();
  return ContentHash(place + "\n" + job.settings.key);
}

// Whether the folder has a result of this very run, whatever it was called.
bool HasResultOf(const StudyJob& job, const std::string& report_path) {
  try {
    const Json report = Json::parse(ReadJsonText(report_path, "not a report"));
    return report.at("key") == FitKey(job.settings, Source(job.outcome.source));
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace

void CheckSameStudy(const std::string& out, std::span<const StudyJob> jobs) {
  bool has_tables = false;
  for (const char* const name : kFilesOfStudy) {
    has_tables = has_tables || (name != std::string(kStudyRecordName) && Exists(out + "/" + name));
  }
  const std::string path = out + "/" + kStudyRecordName;
  if (!Exists(path)) {
    if (!has_tables) return;
    throw Error(
        ErrorKind::kFile,
        "'" + out + "' has tables without " + kStudyRecordName +
            ", which says of what runs they are; give another --out, or overwrite it by --force")
        .At(out)
        .About("replace");
  }
  std::map<std::string, const StudyJob*> job_of;
  for (const StudyJob& job : jobs) job_of[job.run.folder] = &job;
  std::string command;
  bool is_other = false;
  try {
    const Json record = Json::parse(ReadJsonText(path, "not a record of a study"));
    if (record.at("format") != kStudyFormat) {
      throw ErrorIn(ErrorKind::kFormat, path, "not a record of a study");
    }
    command = record.at("command");
    for (const Json& run : record.at("runs")) {
      const std::string folder = run.at("folder");
      const auto job = job_of.find(folder);
      if (job == job_of.end()) {
        is_other = is_other || has_tables;
        continue;
      }
      const std::string report = out + "/" + folder + "/report.json";
      is_other = is_other || (run.at("settings") != SettingsOf(*job->second) && Exists(report) &&
                              !HasResultOf(*job->second, report));
    }
  } catch (const Json::exception&) {
    throw ErrorIn(ErrorKind::kFormat, path, "not a record of a study; give another --out");
  }
  if (!is_other) return;
  throw Error(ErrorKind::kFile,
              "'" + out + "' has another study, whose results this one would replace: " +
                  Printable(command) + "; give another --out, or overwrite it by --force")
      .At(out)
      .About("replace");
}

std::string StudyRecord(std::span<const StudyJob> jobs, const std::string& command) {
  Json runs = Json::array();
  for (const StudyJob& job : jobs) {
    runs.push_back({{"folder", job.run.folder}, {"settings", SettingsOf(job)}});
  }
  return JsonText(Json{{"format", kStudyFormat},
                       {"program", ProgramName()},
                       {"command", command},
                       {"runs", std::move(runs)}},
                  2) +
         "\n";
}

}  // namespace trilobe
