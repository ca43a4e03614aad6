#include "fit/reports/fit_details.h"

#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <variant>

#include "fit/reports/appearance_report.h"
#include "fit/reports/bands_report.h"
#include "fit/reports/bin_counts.h"
#include "fit/reports/model_report.h"
#include "fit/reports/print.h"
#include "fit/reports/verdict_report.h"
#include "io/formats/stretch_json.h"
#include "trilobe/core/base/printable.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

using Json = nlohmann::ordered_json;

Json ToJson(const SolverOptions& options, const SolverEntry& solver) {
  Json json;
  for (const SolverOption* option : OptionsReadBy(solver.options)) {
    std::visit([&](const auto& value) { json[option->name] = value; }, option->get(options));
  }
  return json;
}

Json ToJson(const PhaseSeconds& phases) {
  return {{"reading", phases.reading},
          {"preparing", phases.preparing},
          {"evaluating", phases.evaluating},
          {"tracing", phases.tracing},
          {"linear_algebra", phases.linear_algebra},
          {"diagnosing", phases.diagnosing}};
}

Json ToJson(const std::vector<StartResult>& starts) {
  Json array = Json::array();
  for (const StartResult& start : starts) {
    array.push_back({{"name", start.name}, {"objective", start.objective}});
    if (start.minimum > 0) array.back()["minimum"] = start.minimum;
  }
  return array;
}

Json ToJson(const std::vector<Candidate>& candidates) {
  Json array = Json::array();
  for (const Candidate& candidate : candidates) {
    array.push_back({{"name", candidate.name},
                     {"parameters", candidate.num_parameters},
                     {"objective", candidate.E},
                     {"psnr_db", candidate.score},
                     {"fails_beyond_data", candidate.fails_beyond},
                     {"has_rings", candidate.has_rings},
                     {"seconds", candidate.seconds}});
  }
  return array;
}

// Finishing steps after the solver, in order.
Json FinishingJson(const FitReport::Finished& finished) {
  Json array = Json::array();
  for (const FinishingStep& step : finished.steps) {
    array.push_back({{"step", step.name},
                     {"objective_before", step.objective_before},
                     {"objective_after", step.objective_after},
                     {"seconds", step.seconds}});
    if (step.name == "reflected_light" && finished.matched) {
      array.back()["error_before"] = finished.matched->error_before;
      array.back()["error_after"] = finished.matched->error_after;
    }
  }
  return array;
}

// The iterations that raised what the solver lowers, as the filter of G may.
Json RaisesJson(const SolverSummary& summary) {
  const SolverSummary::Raises raises = summary.FindRaises();
  return {{"iterations", raises.iterations}, {"largest", raises.largest}};
}

Json ToJson(const NodeChoice& choice) {
  Json tried = Json::array();
  for (const Candidate& candidate : choice.tried) {
    tried.push_back({{"name", candidate.name},
                     {"parameters", candidate.num_parameters},
                     {"relative_objective", candidate.E},
                     {"seconds", candidate.seconds}});
  }
  return {{"chosen", choice.tried[choice.chosen].name},
          {"held_out_samples", choice.held_out},
          {"tried", tried}};
}

// Line on reciprocity, if that is much of E.
std::string Irreducible(const ScoreReport& score) {
  constexpr double kMuch = 0.1;
  const double share = IrreducibleShare(score);
  if (share < kMuch) return "";
  return "reciprocity  " + Text(100 * share, 3) +
         " % of E is what exchanged directions differ by in the data, noise included; no "
         "reciprocal model lowers it\n";
}

std::string StretchLine(const ModelSpec& spec) {
  if (!spec.stretches.any()) return "";
  return "stretch      highlights widen with theta_d by 1 / cos^x, x along the plane of both "
         "directions and across it: " +
         DescribeStretches(spec) + "\n";
}

// Lines on the chosen nodes and the other candidates.
std::string Describe(const NodeChoice& choice) {
  const Candidate& chosen = choice.tried[choice.chosen];
  std::string text = "nodes        chosen by error on held-out directions: " + chosen.name +
                     " (E held out " + Text(100 * chosen.E, 3) + " % of a black model's";
  const char* before = "; others: ";
  for (const Candidate& candidate : choice.tried) {
    if (candidate.name == chosen.name) continue;
    text += before + candidate.name + " " + Text(100 * candidate.E, 3) + " %";
    before = "; ";
  }
  return text + ")\n";
}

std::string Describe(const FitReport::Prior& prior) {
  return "prior        a small model, fitted first, speaks for " + std::to_string(prior.samples) +
         " directions between the measured ones, each of weight " + Text(prior.weight) +
         "; E is of the measured directions alone, but where it says otherwise\n";
}

// Lines on the chosen form and the other candidates.
std::string Describe(const FitReport::Finished& finished) {
  std::string text;
  if (finished.held_out > 0) {
    text +=
        "held out     " + std::to_string(finished.held_out) +
        " samples, by which candidates were judged; E of these is of what they were fitted to\n";
  }
  for (size_t k = 0; k < finished.candidates.size(); ++k) {
    const Candidate& candidate = finished.candidates[k];
    text += (k == 0 ? "candidates   " : "             ") + candidate.name + ": PSNR " +
            Text(candidate.score) + " dB, " + std::to_string(candidate.num_parameters) +
            " parameters, E " + Text(candidate.E) +
            (candidate.fails_beyond ? ", but fails beyond the data" : "") +
            (candidate.has_rings ? ", but has rings under even light" : "") +
            (static_cast<int>(k) == finished.chosen ? "   <- chosen\n" : "\n");
  }
  if (finished.matched) {
    text += "reflectance  was off by " + Text(100 * finished.matched->error_before, 3) +
            " %, now by " + Text(100 * finished.matched->error_after, 3) + " %\n";
  }
  return text;
}

Json ToJson(const Diagnosis& diagnosis) {
  return {{"optimality", diagnosis.optimality},
          {"live_parameters", diagnosis.observed_parameters},
          {"rank", diagnosis.rank},
          {"rank_tolerance", diagnosis.rank_tolerance},
          {"unresolved", diagnosis.unresolved},
          {"condition", diagnosis.condition}};
}

Json ToJson(const HeldOutError& held_out) {
  return {{"samples", held_out.samples},
          {"objective", held_out.objective},
          {"relative_objective", held_out.relative_objective},
          {"psnr_db", held_out.psnr_db},
          {"mean_delta_e", held_out.mean_delta_e}};
}

}  // namespace

nlohmann::ordered_json ToJson(const FitReport& report) {
  const FitInfo& fit = report.fit;
  const SolverSummary& summary = report.summary;
  const ScoreReport& score = report.score;
  const FitReport::Seconds& seconds = report.seconds;
  const SolverEntry& solver = FindSolver(fit.solver);
  return {
      {"format", kReportFormat},
      {"verdict", ToJson(VerdictOn(report))},
      {"source", fit.source},
      {"source_xxh128", fit.source_xxh128},
      {"noise", report.noise},
      {"seed", report.seed},
      {"data_seed", report.data_seed},
      {"valid_samples", fit.valid_samples},
      {"max_angle", fit.max_angle},
      {"bins", ToJson(report.bins)},
      {"data_notes", report.data_notes},
      {"solver", fit.solver},
      {"init", fit.init},
      {"weighting", fit.weighting},
      {"model", ModelName(report.spec)},
      {"lobes", report.spec.lobes},
      {"stretch", StretchesToJson<Json>(report.spec)},
      {"parameters", report.spec.num_parameters()},
      {"stored_parameters", report.stored_parameters},
      {"candidates", ToJson(report.finished.candidates)},
      {"candidates_held_out", report.finished.held_out},
      {"azimuths", report.azimuths
                       ? Json{{"matter", report.azimuths->matter}, {"why", report.azimuths->why}}
                       : Json()},
      {"nodes", report.nodes ? ToJson(*report.nodes) : Json()},
      {"prior", report.prior
                    ? Json{{"weight", report.prior->weight},
                           {"samples", report.prior->samples},
                           {"initial_objective", summary.trace.front().minimised()},
                           {"objective", summary.trace[summary.BestIteration()].minimised()}}
                    : Json()},
      {"raw", report.raw},
      {"finishing", FinishingJson(report.finished)},
      {"threads", fit.threads},
      {"options",
       {{"given", ToJson(summary.given, solver)}, {"used", ToJson(summary.used, solver)}}},
      {"notes", summary.notes},
      {"starts", ToJson(summary.starts)},
      {"stop_reason", fit.stop_reason},
      {"iterations", fit.iterations},
      {"best_iteration", summary.BestIteration()},
      {"rejected_steps", summary.RejectedSteps()},
      {"raised", RaisesJson(summary)},
      {"initial_objective", fit.initial_objective},
      {"solver_objective", summary.final_objective},
      {"objective", score.objective},
      {"relative_objective", score.relative_objective},
      {"irreducible_objective", score.irreducible_objective},
      {"psnr_db", score.psnr_db},
      {"psnr_peak", score.psnr_peak},
      {"rmse", score.rmse},
      {"mean_relative_error", score.mean_relative_error},
      {"mean_log_error", score.mean_log_error},
      {"appearance", report.appearance ? ToJson(*report.appearance) : Json()},
      {"anisotropy_left_out", report.left_out ? Json(*report.left_out) : Json()},
      {"reach", report.reach ? Json{{"between_samples", report.reach->between},
                                    {"beyond_samples", report.reach->beyond}}
                             : Json()},
      {"light", ToJson(report.light)},
      {"repeats", report.repeats ? Json{{"samples", report.repeats->samples},
                                        {"relative_objective", report.repeats->relative_objective}}
                                 : Json()},
      {"held_out", report.held_out ? ToJson(*report.held_out) : Json()},
      {"spectral", report.bands ? ToJson(*report.bands, report.bands_seen) : Json()},
      {"diagnosis", summary.diagnosis ? ToJson(*summary.diagnosis) : Json()},
      {"seconds",
       {{"read", seconds.read},
        {"prepare", seconds.prepare},
        {"init", seconds.init},
        {"nodes", seconds.nodes},
        {"solve", seconds.solve},
        {"finish", seconds.finish},
        {"bands", seconds.bands},
        {"score", seconds.score},
        {"held_out", seconds.held_out},
        {"draw", seconds.draw}}},
      {"phases", ToJson(summary.phases)},
      {"peak_memory_bytes", report.peak_memory ? Json(*report.peak_memory) : Json()},
      {"machine", {{"processor", report.processor}, {"side_by_side", report.side_by_side}}},
      {"program", fit.program},
      {"date", fit.date},
      {"key", report.key},
      {"interrupted", report.interrupted},
      {"run", fit.run},
      {"files", report.files},
      {"checksums", report.checksums}};
}

void PrintDetails(const FitReport& report) {
  const FitInfo& fit = report.fit;
  const ScoreReport& score = report.score;
  std::cout << "source       " << Printable(fit.source) << ", " << fit.valid_samples
            << " valid samples up to " << Text(fit.max_angle) << " deg\n"
            << "left out     bins " << LeftOutText(report.bins) << "\n"
            << "model        " << report.spec.lobes << " lobes, " << ParametersText(report)
            << ", weighting " << fit.weighting << ", from " << fit.init << "\n"
            << report.summary.FullReport() << "error        E is "
            << Text(100 * score.relative_objective) << " % of a black model's; PSNR "
            << Text(score.psnr_db) << " dB (peak " << Text(score.psnr_peak) << " /sr), RMSE "
            << Text(score.rmse) << " /sr, mean relative error "
            << RelativeErrorText(score.mean_relative_error) << "\n"
            << Irreducible(score) << StretchLine(report.spec)
            << (report.nodes ? Describe(*report.nodes) : "")
            << (report.prior ? Describe(*report.prior) : "") << Describe(report.finished)
            << (report.appearance
                    ? Describe(*report.appearance)
                    : "appearance   samples on no grid are not compared on a sphere; slices.png "
                      "holds the fit against them\n")
            << (report.left_out
                    ? "azimuths     an isotropic model leaves out " +
                          Text(100 * *report.left_out, 3) +
                          " % of the energy: what differs from the mean over all turns of the "
                          "sample\n"
                    : "")
            << "light        " << Describe(report.light) << "\n";
  if (report.peak_memory) {
    std::cout << "memory       " << Text(static_cast<double>(*report.peak_memory) / 1e6, 3)
              << " MB at most\n";
  }
}

}  // namespace trilobe
