#include "app/fit_many.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "app/command.h"
#include "app/fit_jobs.h"
#include "app/fit_page.h"
#include "app/flags.h"
#include "app/inputs.h"
#include "app/interrupt.h"
#include "app/result_folder.h"
#include "core/base/quantile.h"
#include "core/files/file.h"
#include "core/files/json_value.h"
#include "fit/reports/print.h"
#include "model/appearance/verdict.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/printable.h"

DECLARE_string(shard);

namespace trilobe {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Text such as "7 of 9 cannot be told apart; sphere 45.2 dB in the median, at least 33 (brass)", on
// the outcomes that have a model.
std::string Summary(std::vector<FitOutcome> outcomes) {
  std::erase_if(outcomes, [](const FitOutcome& outcome) { return outcome.verdict.empty(); });
  const auto same =
      std::ranges::count(outcomes, NameOf(Visibility::kNone), &FitOutcome::visibility);
  const std::string verdicts =
      std::to_string(same) + " of " + std::to_string(outcomes.size()) + " cannot be told apart; ";
  std::erase_if(outcomes, [](const FitOutcome& outcome) { return !outcome.has_picture; });
  if (outcomes.empty()) return verdicts + "no picture";
  std::vector<double> psnr_db;
  for (const FitOutcome& outcome : outcomes) psnr_db.push_back(outcome.psnr_db);
  const FitOutcome& least = *std::ranges::min_element(outcomes, {}, &FitOutcome::psnr_db);
  return verdicts + "sphere " + Text(Median(std::move(psnr_db)), 3) +
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
  if (outcome.glows) {
    std::cerr << "trilobe: the model of " << Printable(outcome.name)
              << " reflects more light than falls on it, as its last step was stopped; "
                 "`trilobe info` of its model.json says at which angles\n";
  }
  if (!outcome.undrawn.empty()) {
    std::cerr << "trilobe: pictures of " << Printable(outcome.name)
              << " are missing: " << Printable(outcome.undrawn) << "\n";
  }
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
    throw Error(
        ErrorKind::kMissing,
        "'" + folder + "' has no folder of a fit, with model.json and report.json in it" +
            (fs::exists(model) ? "; to look at one model, give '" + model.string() + "'" : ""))
        .At(folder);
  }
  std::ranges::sort(names);
  std::vector<FitOutcome> outcomes;
  for (const std::string& name : names) {
    const fs::path place = fs::path(folder) / name;
    FitOutcome& outcome = outcomes.emplace_back(FitOutcome{.name = name, .source = ""});
    const std::string path = (place / "report.json").string();
    try {
      const Json report = Json::parse(ReadJsonText(path, "not a report"));
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
  if (FLAGS_verbose) {
    throw Error(ErrorKind::kConflict, "--verbose is for the fit of one SOURCE; leave it out")
        .About("verbose");
  }
  const int threads = ThreadsFromFlags();
  settings.side_by_side = threads;
  settings.pair = true;
  settings.key += "pair\n";
  const std::vector<FitOutcome> all = ListSources(arguments);
  std::vector<std::string> read = settings.inputs;
  for (const FitOutcome& outcome : all) read.push_back(outcome.source);
  const Inputs inputs(read);
  std::vector<FitOutcome> outcomes;
  for (const size_t k : JobsOfShard(all.size())) outcomes.push_back(all[k]);
  std::vector<ResultFolder> folders;
  for (const FitOutcome& outcome : outcomes) {
    folders.emplace_back(out + "/" + outcome.name, FitFileNames(), inputs);
  }
  const ResultFolder summary(out, {kTableName, kPageName}, inputs);
  summary.Open();

  const InterruptGuard guard;
  MakeJobs(
      outcomes.size(), threads, "measurements",
      [&](size_t k) -> FitOutcome& { return outcomes[k]; },
      [&](size_t k) { FitOrKeep(settings, &folders[k], &outcomes[k]); },
      [&](size_t k, size_t done) {
        PrintOutcome(outcomes[k], done, outcomes.size());
        outcomes[k].error = ErrorToSend(outcomes[k].error, outcomes[k], out);
      });

  std::string written = "a folder each";
  if (FLAGS_shard.empty()) {
    WriteFile(summary.PathOf(kTableName), [&](std::ostream& out) { out << FitsCsv(outcomes); });
    WriteFile(summary.PathOf(kPageName),
              [&](std::ostream& page) { page << FitsPage(outcomes, out, kTableName); });
    written += std::string(", ") + kTableName + ", " + kPageName;
  }
  const auto failed = std::ranges::count(outcomes, FitOutcome::State::kFailed, &FitOutcome::state);
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
