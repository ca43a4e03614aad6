#include "app/fit_jobs.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <limits>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

#include "app/command.h"
#include "app/flags.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/status.h"
#include "core/base/file_names.h"
#include "core/files/content.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "core/files/utf16.h"
#include "fit/reports/fit_details.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"

DEFINE_string(shard, "",
              "i/n: make only every n-th of many fits, from the i-th on, and leave the page to the "
              "same command without --shard, after all shards have ended");

namespace trilobe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Whether a file of a folder is to be fitted: by the ending of a format but JSON, or by its
// content; and what holds a measurement that is not read, so that its error says what to do.
bool IsMeasurement(const std::string& path) {
  const std::string ending = EndingOf(path);
  const auto is_one_of = [&](std::initializer_list<std::string_view> endings) {
    return std::ranges::find(endings, ending) != endings.end();
  };
  if (std::ranges::any_of(MeasurementFormats(), [&](const MeasurementFormat& format) {
        return format.ending == ending && !(format.is_json && ending == ".json");
      })) {
    return true;
  }
  if (is_one_of({".xlsx", ".xls", ".ods", ".mat", ".h5", ".hdf5", ".npy", ".npz", ".axf", ".gz"})) {
    return true;
  }
  constexpr size_t kLookedAt = 1 << 16;
  const std::string bytes = BeginningOf(path, kLookedAt), utf8 = Utf8OfUtf16(bytes);
  return RecogniseFormat(utf8.empty() ? bytes : utf8) != nullptr;
}

// Says that a file of a folder is not fitted, and why.
void TellSkipped(const std::string& path) {
  std::string why = path + ": no measurement";
  try {
    Source(path).Read();
  } catch (const Error& error) {
    why = error.what();
    why.resize(std::min(why.find("; a measurement is"), why.size()));  // not each time
  }
  std::cerr << "trilobe: skipped " << Printable(why) << "\n";
}

// The measurements in a folder, by name.
std::vector<std::string> MeasurementsIn(const std::string& folder) {
  std::vector<std::string> found, skipped;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename() == kTableName) continue;  // of an earlier run
    const std::string path = it->path().string();
    if (IsMeasurement(path)) {
      found.push_back(path);
    } else if (it->is_regular_file(error) && it->path().filename().string().front() != '.') {
      skipped.push_back(path);
    }
  }
  if (error) {
    throw Error(ErrorKind::kFile, "cannot read the folder '" + folder + "': " + error.message())
        .At(folder)
        .About("read", error.message());
  }
  if (found.empty()) {
    std::string endings;
    for (const MeasurementFormat& format : MeasurementFormats()) {
      const std::string ending = " *" + format.ending;
      if ((endings + " ").find(ending + " ") == std::string::npos) endings += ending;
    }
    throw Error(ErrorKind::kMissing,
                "'" + folder + "' has no measurement, no file of these:" + endings)
        .At(folder);
  }
  std::ranges::sort(skipped);
  std::ranges::for_each(skipped, TellSkipped);
  std::ranges::sort(found);
  return found;
}

}  // namespace

std::vector<FitOutcome> ListSources(std::span<const std::string> arguments) {
  std::vector<std::string> sources;
  for (const std::string& argument : arguments) {
    std::error_code ignored;
    if (fs::is_directory(argument, ignored)) {
      std::ranges::copy(MeasurementsIn(argument), std::back_inserter(sources));
    } else {
      sources.push_back(argument);
    }
  }
  std::map<std::string, std::string> source_of;
  std::vector<FitOutcome> outcomes;
  for (const std::string& source : sources) {
    const std::string name = FitNameOf(source);
    if (name.empty() || name == "." || name == ".." || name == kTableName || name == kPageName) {
      throw Error(ErrorKind::kRange, "'" + source + "' gives no name for a folder; rename it")
          .About("SOURCE", source);
    }
    const auto [other, is_new] = source_of.emplace(name, source);
    if (!is_new) {
      throw Error(ErrorKind::kConflict, "'" + other->second + "' and '" + source +
                                            "' would both be fitted into '" + name +
                                            "'; rename one, or fit it by a command of its own")
          .About("SOURCE", source);
    }
    outcomes.push_back({.name = name, .source = source});
  }
  return outcomes;
}

std::vector<size_t> JobsOfShard(size_t count_of_jobs) {
  int first = 1, count = 1;
  if (!FLAGS_shard.empty()) {
    char slash = 0;
    std::istringstream text(FLAGS_shard);
    text >> first >> slash >> count;
    if (!text || slash != '/' || text.peek() != EOF || first < 1 || first > count) {
      throw Error(ErrorKind::kFormat,
                  "--shard=" + FLAGS_shard + " is no i/n with i from 1 to n, as 2/8 is")
          .About("shard", FLAGS_shard);
    }
  }
  std::vector<size_t> jobs;
  for (size_t k = first - 1; k < count_of_jobs; k += count) jobs.push_back(k);
  return jobs;
}

void TakeReport(const Json& report, FitOutcome* outcome) {
  const Json& sphere = report.at("appearance");
  outcome->has_picture = !sphere.is_null() && !report.at("interrupted").get<bool>();
  if (outcome->has_picture) {
    outcome->psnr_db = sphere.at("psnr_db").is_null() ? std::numeric_limits<double>::infinity()
                                                      : sphere.at("psnr_db").get<double>();
    outcome->mean_delta_e = sphere.at("mean_delta_e");
    outcome->mean_color_error = sphere.at("mean_color_error");
  }
  outcome->verdict = report.at("verdict").at("words");
  outcome->visibility = report.at("verdict").at("visibility");
  outcome->objective = report.at("objective");
  outcome->num_parameters = report.contains("stored_parameters") ? report.at("stored_parameters")
                                                                 : report.at("stored_numbers");
  outcome->anisotropic = report.at("model") == "anisotropic";
  const Json& advice = report.at("verdict").at("advice");
  outcome->glows = std::ranges::find(advice, Json("glows")) != advice.end();
  const Json& files = report.at("files");
  if (std::ranges::find(files, Json("view.html")) != files.end()) outcome->page = "view.html";
  outcome->seconds = 0;
  for (const auto& [phase, seconds] : report.at("seconds").items()) {
    outcome->seconds += seconds.get<double>();
  }
}

namespace {

// Whether the folder has what this fit leaves, whole and of one run. The measurement, of which the
// key is made, is read only where all else holds.
bool IsFinished(const FitSettings& settings, const ResultFolder& folder, FitOutcome* outcome) {
  try {
    const std::string path = folder.PathOf("report.json");
    const Json report = Json::parse(ReadJsonText(path, "not a report"));
    if (report.at("interrupted") ||
        report.at("run") != ReadModel(folder.PathOf("model.json")).fit.run) {
      return false;
    }
    const std::vector<std::string> files = folder.Files();
    for (const std::string name : report.at("files")) {
      if (std::ranges::find(files, name) == files.end()) return false;
    }
    if (report.at("key") != FitKey(settings, Source(outcome->source))) return false;
    TakeReport(report, outcome);
    return true;
  } catch (const Error&) {
    return false;  // nothing there, or not to be read
  } catch (const Json::exception&) {
    return false;  // of another version
  }
}

}  // namespace

void FitOrKeep(const FitSettings& settings, ResultFolder* folder, FitOutcome* outcome) {
  if (IsFinished(settings, *folder, outcome)) {
    outcome->state = FitOutcome::State::kKept;
    return;
  }
  std::optional<FitRun> run = RunOneFit(
      outcome->source, settings, 1, folder, [] {}, [](const IterationRecord&) {},
      [](const StartProgress&) {});
  if (!run) return;
  outcome->earlier = run->earlier;
  outcome->undrawn = WriteOtherFiles(&*run, settings, folder);
  TakeReport(ToJson(run->report), outcome);
  const std::vector<std::string>& files = run->report.files;
  outcome->has_picture =
      outcome->has_picture && std::ranges::find(files, outcome->picture) != files.end();
  outcome->state =
      run->report.interrupted ? FitOutcome::State::kInterrupted : FitOutcome::State::kFitted;
}

void MakeJobs(size_t count, int at_once, const std::string& things,
              const std::function<FitOutcome&(size_t k)>& outcome_of,
              const std::function<void(size_t k)>& make,
              const std::function<void(size_t k, size_t done)>& tell) {
  JobProgress progress(count, things);
  std::mutex mutex;
  size_t done = 0;
  ParallelJobs(static_cast<int>(count), at_once, [&](int k) {
    if (InterruptGuard::signal() != 0) return;
    FitOutcome& outcome = outcome_of(k);
    try {
      make(k);
    } catch (const std::exception& exception) {
      outcome.state = FitOutcome::State::kFailed;
      outcome.error = MessageOf(exception);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    Status::Clear();
    tell(k, ++done);
    progress.Done(outcome.name, outcome.state != FitOutcome::State::kKept);
  });
}

std::string ErrorToSend(const std::string& error, const FitOutcome& outcome,
                        const std::string& out) {
  std::error_code ignored;
  return WithoutFolders(error, {fs::path(outcome.source).parent_path().string(), out,
                                fs::current_path(ignored).string()});
}

}  // namespace trilobe
