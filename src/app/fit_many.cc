#include "app/fit_many.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/fit_page.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/progress.h"
#include "app/result_folder.h"
#include "core/base/file_names.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "fit/reports/fit_details.h"
#include "fit/reports/print.h"
#include "model/appearance/verdict.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/io/model_files/model_file.h"

DEFINE_string(shard, "",
              "i/n: of many SOURCEs fit only every n-th, from the i-th on, and leave the page to "
              "the same command without --shard, when all shards are through");

namespace trilobe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

// The measurements in a folder, by name.
std::vector<std::string> MeasurementsIn(const std::string& folder) {
  std::vector<std::string> found;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const std::string ending = EndingOf(it->path().string());
    if (it->path().filename() == kTableName) continue;  // of an earlier run
    if (std::ranges::find(MeasurementFormats(), ending, &MeasurementFormat::ending) !=
        MeasurementFormats().end()) {
      found.push_back(it->path().string());
    }
  }
  if (error) throw Error("cannot read the folder '" + folder + "': " + error.message());
  if (found.empty()) {
    std::string endings;
    for (const MeasurementFormat& format : MeasurementFormats()) {
      const std::string ending = " *" + format.ending;
      if ((endings + " ").find(ending + " ") == std::string::npos) endings += ending;
    }
    throw Error("'" + folder + "' has no measurement, no file of these:" + endings);
  }
  std::ranges::sort(found);
  return found;
}

// Folders replaced by what is in them. Each becomes a folder of its own, so names must differ.
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
      throw Error("'" + source + "' gives no name for a folder; rename it");
    }
    const auto [other, is_new] = source_of.emplace(name, source);
    if (!is_new) {
      throw Error("'" + other->second + "' and '" + source + "' would both be fitted into '" +
                  name + "'; rename one, or fit it by a command of its own");
    }
    outcomes.push_back({.name = name, .source = source});
  }
  return outcomes;
}

// Those that --shard leaves.
std::vector<FitOutcome> SelectShard(const std::vector<FitOutcome>& outcomes) {
  if (FLAGS_shard.empty()) return outcomes;
  int first = 0, count = 0;
  char slash = 0;
  std::istringstream text(FLAGS_shard);
  text >> first >> slash >> count;
  if (!text || slash != '/' || text.peek() != EOF || first < 1 || first > count) {
    throw Error("--shard=" + FLAGS_shard + " is no i/n with i from 1 to n, as 2/8 is");
  }
  std::vector<FitOutcome> shard;
  for (size_t k = first - 1; k < outcomes.size(); k += count) shard.push_back(outcomes[k]);
  return shard;
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
  const Json& files = report.at("files");
  if (std::ranges::find(files, Json("view.html")) != files.end()) outcome->page = "view.html";
  outcome->seconds = 0;
  for (const auto& [phase, seconds] : report.at("seconds").items()) {
    outcome->seconds += seconds.get<double>();
  }
}

// Whether the folder has what this fit leaves, whole and of one run. The measurement, of which the
// key is made, is read only where all else holds.
bool IsFinished(const FitSettings& settings, const ResultFolder& folder, FitOutcome* outcome) {
  try {
    const std::string path = folder.PathOf("report.json");
    const Json report = Json::parse(ReadJsonText(path, path + ": not a report"));
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

// "7 of 9 cannot be told apart; sphere 45.2 dB in the median, at least 33 (brass)", of those that
// have a model.
std::string Summary(std::vector<FitOutcome> outcomes) {
  std::erase_if(outcomes, [](const FitOutcome& outcome) { return outcome.verdict.empty(); });
  const auto same =
      std::ranges::count(outcomes, NameOf(Visibility::kNone), &FitOutcome::visibility);
  const std::string verdicts =
      std::to_string(same) + " of " + std::to_string(outcomes.size()) + " cannot be told apart; ";
  std::erase_if(outcomes, [](const FitOutcome& outcome) { return !outcome.has_picture; });
  if (outcomes.empty()) return verdicts + "no picture";
  std::ranges::sort(outcomes, {}, &FitOutcome::psnr_db);
  const FitOutcome& least = outcomes.front();
  return verdicts + "sphere " + Text(outcomes[outcomes.size() / 2].psnr_db, 3) +
         " dB in the median, at least " + Text(least.psnr_db, 3) + " (" + Printable(least.name) +
         ")";
}

void PrintOutcome(const FitOutcome& outcome, size_t done, size_t count) {
  std::cout << "[" << done << "/" << count << "] " << Printable(outcome.name) << ": "
            << StateName(outcome.state);
  if (outcome.has_model()) {
    std::cout << ", " << outcome.verdict;
    if (outcome.has_picture) {
      std::cout << ", sphere " << Text(outcome.psnr_db, 3) << " dB, CIELAB difference "
                << Text(outcome.mean_delta_e, 2);
    }
    std::cout << ", E " << Text(outcome.objective, 5) << ", " << outcome.num_parameters
              << " parameters, " << Text(outcome.seconds, 3) << " s";
  }
  if (!outcome.earlier.empty()) {
    std::cout << "; the earlier model, of " << Printable(outcome.earlier) << ", is "
              << kPreviousModelName;
  }
  if (!outcome.error.empty()) std::cout << ": " << outcome.error;
  std::cout << std::endl;
  if (!outcome.undrawn.empty()) {
    std::cerr << "trilobe: pictures of " << Printable(outcome.name)
              << " are missing: " << Printable(outcome.undrawn) << "\n";
  }
}

// Why a fit failed, for the table and the page, which may go to others.
std::string ErrorToSend(const std::string& error, const FitOutcome& outcome,
                        const std::string& out) {
  std::error_code ignored;
  return WithoutFolders(error, {fs::path(outcome.source).parent_path().string(), out,
                                fs::current_path(ignored).string()});
}

}  // namespace

std::vector<FitOutcome> ReadFitsIn(const std::string& folder) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (fs::exists(entry.path() / "report.json") && fs::exists(entry.path() / "model.json")) {
      names.push_back(entry.path().filename().string());
    }
  }
  if (names.empty()) {
    const fs::path model = fs::path(folder) / "model.json";
    throw Error("'" + folder + "' has no folder of a fit, with model.json and report.json in it" +
                (fs::exists(model) ? "; to look at one model, give '" + model.string() + "'" : ""));
  }
  std::ranges::sort(names);
  std::vector<FitOutcome> outcomes;
  for (const std::string& name : names) {
    const fs::path place = fs::path(folder) / name;
    FitOutcome& outcome = outcomes.emplace_back(FitOutcome{.name = name, .source = ""});
    const std::string path = (place / "report.json").string();
    try {
      const Json report = Json::parse(ReadJsonText(path, path + ": not a report"));
      outcome.state = FitOutcome::State::kFitted;
      outcome.source = report.at("source");
      TakeReport(report, &outcome);
      if (!fs::exists(place / outcome.picture)) outcome.picture = "spheres.png";
      outcome.has_picture = outcome.has_picture && fs::exists(place / outcome.picture);
    } catch (const Error& error) {
      outcome.state = FitOutcome::State::kFailed;
      outcome.error = ErrorToSend(error.what(), outcome, folder);
    } catch (const Json::exception&) {
      outcome.state = FitOutcome::State::kFailed;
      outcome.error = name + "/report.json: not a report of this version";
    }
  }
  return outcomes;
}

int RunFitOfMany(std::span<const std::string> arguments, FitSettings settings) {
  const std::string out = RequiredOut("fit SOURCE...", "DIR");
  if (FLAGS_verbose) throw Error("--verbose is for the fit of one SOURCE; leave it out");
  settings.pair = true;
  settings.key += "pair\n";
  const std::vector<FitOutcome> all = ListSources(arguments);
  std::vector<std::string> read = settings.inputs;
  for (const FitOutcome& outcome : all) read.push_back(outcome.source);
  const Inputs inputs(read);
  std::vector<FitOutcome> outcomes = SelectShard(all);
  std::vector<ResultFolder> folders;
  for (const FitOutcome& outcome : outcomes) {
    folders.emplace_back(out + "/" + outcome.name, FitFileNames(), FitFolderMarks(), inputs);
  }
  const ResultFolder summary(out, {kTableName, kPageName}, {kTableName, kPageName}, inputs);
  summary.Open();

  const InterruptGuard guard;
  JobProgress progress(outcomes.size(), "measurements");
  std::mutex mutex;
  size_t done = 0;
  ParallelJobs(static_cast<int>(outcomes.size()), ThreadsFromFlags(), [&](int k) {
    if (InterruptGuard::signal() != 0) return;
    FitOutcome& outcome = outcomes[k];
    try {
      FitOrKeep(settings, &folders[k], &outcome);
    } catch (const std::exception& exception) {
      outcome.state = FitOutcome::State::kFailed;
      outcome.error = MessageOf(exception);
    }
    const std::lock_guard<std::mutex> lock(mutex);
    progress.Clear();
    PrintOutcome(outcome, ++done, outcomes.size());
    progress.Done(outcome.name, outcome.state != FitOutcome::State::kKept);
    outcome.error = ErrorToSend(outcome.error, outcome, out);
  });

  std::string written = "a folder each";
  if (FLAGS_shard.empty()) {
    WriteFile(summary.PathOf(kTableName), [&](std::ostream& out) { out << FitsCsv(outcomes); });
    WriteFile(summary.PathOf(kPageName),
              [&](std::ostream& out) { out << FitsPage(outcomes, kTableName); });
    written += std::string(", ") + kTableName + ", " + kPageName;
  }
  const auto failed = std::ranges::count(outcomes, FitOutcome::State::kFailed, &FitOutcome::state);
  progress.Clear();
  std::cout << "all          " << Summary(outcomes) << "\n"
            << "written      " << written << " in " << Printable(out)
            << (failed > 0 ? "; " + std::to_string(failed) + " failed" : "") << "\n";
  if (InterruptGuard::signal() != 0) {
    std::cout << "interrupted  the same command goes on with what is missing\n";
    return 128 + InterruptGuard::signal();
  }
  return failed > 0 ? kSomeFailed : 0;
}

}  // namespace trilobe
