#include "fit/reports/fit_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <utility>

#include "fit/reports/appearance_report.h"
#include "fit/reports/bands_report.h"
#include "fit/reports/print.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

// Whether --model=auto would have chosen among forms.
bool MayChooseForm(const FitReport& report) {
  const bool of_table = report.appearance && !report.appearance->at_nodes;
  const bool named_start = std::ranges::find(InitialModels(), report.fit.init,
                                             &InitialModel::name) != InitialModels().end();
  return of_table && named_start && report.finished.candidates.empty() &&
         ModelName(report.spec) == "shared" && report.spec.lobes >= ModelSpec().lobes;
}

std::string EndText(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "converged";
    case StopReason::kOptimal:
      return "at a minimum";
    case StopReason::kExactFit:
      return "exact";
    case StopReason::kNoDecrease:
      return "no step lowers E any more";
    case StopReason::kMaxIterations:
      return "stopped by --max_iterations";
    case StopReason::kMaxSeconds:
      return "stopped by --max_seconds";
    case StopReason::kInterrupted:
      return "interrupted";
  }
  return "";
}

std::string FormText(const FitReport& report) {
  std::string text = std::to_string(report.spec.lobes) +
                     (report.spec.lobes == 1 ? " lobe of " : " lobes of ") + ParametersText(report);
  const FitReport::Finished& finished = report.finished;
  if (finished.chosen < 0) return text;
  return text + ", the best of " + std::to_string(finished.candidates.size()) + " forms (" +
         finished.candidates[finished.chosen].name + ")";
}

double RelativeTo(double black, double E) { return black > 0 ? E / black : 0; }

// Text on the steps after the solver, and by how much each moved E.
std::string FinishedText(const FitReport& report) {
  std::string text;
  for (const FinishingStep& step : report.finished.steps) {
    std::string name = step.name;
    std::ranges::replace(name, '_', ' ');
    text += (text.empty() ? "" : ", ") + name;
    if (step.objective_before > 0) {
      const double percent = 100 * (step.objective_after / step.objective_before - 1);
      text += (percent < 0 ? " -" : " +") + Text(std::abs(percent), 2) + " %";
    }
  }
  return text;
}

std::string Hundredths(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", seconds);
  return text;
}

}  // namespace

void FillReport(const FitResult& fit, FitReport* report) {
  report->interrupted = fit.interrupted;
  report->spec = fit.model().spec();
  report->summary = fit.summary;
  report->azimuths = fit.azimuths;
  report->nodes = fit.nodes;
  report->prior = fit.prior;
  report->raw = fit.raw;
  report->finished = fit.finished;
  report->black_objective = fit.objective.MeasuredEnergy();
  report->stored_parameters = fit.stored_parameters;
  report->score = fit.score;
  report->appearance = fit.appearance;
  report->samples_seen = fit.samples_seen;
  report->left_out = fit.left_out;
  report->reach = fit.reach;
  report->measured_share = fit.measured_share;
  report->whole = fit.whole;
  report->light = fit.light;
  report->bands = fit.bands;
  report->bands_seen = fit.bands_seen;
  report->ripple = fit.ripple;
  report->repeats = fit.repeats;
  report->held_out = fit.held_out;
  static_cast<FitResult::Seconds&>(report->seconds) = fit.seconds;
}

std::string ParametersText(const FitReport& report) {
  const int all = report.spec.num_parameters();
  std::string text = std::to_string(all) + " parameters";
  if (report.stored_parameters < all) {
    text += ", " + std::to_string(report.stored_parameters) + " of them stored";
  }
  return text;
}

// Beyond the samples a material may be any number of times as bright; see AlbedoLimits.
std::string ReachText(const Reach& reach) {
  constexpr double kNotable = 2;
  if (reach.between < kNotable) return "";
  return "reach        between the samples the model reaches " + Text(reach.between, 3) +
         " times the largest measured value\n";
}

ReportedVerdict VerdictOn(const FitReport& report) {
  return MakeVerdict(report.appearance, report.samples_seen,
                     {.measured_share = report.measured_share,
                      .samples = report.fit.valid_samples,
                      .parameters = report.stored_parameters,
                      .black = !(report.black_objective > 0),
                      .whole = report.whole},
                     {.interrupted = report.interrupted,
                      .ended = HasEnded(report.summary.stop_reason),
                      .may_choose_form = MayChooseForm(report),
                      .default_solver = report.summary.solver == Solvers().front().name,
                      .irreducible = IrreducibleShare(report.score),
                      .left_out = report.left_out,
                      .glow = report.finished.glow ? report.finished.glow->albedo : 0,
                      .glow_theta_i = report.finished.glow ? report.finished.glow->theta_i : 0,
                      .ripple = report.ripple.share,
                      .ripple_theta_i = report.ripple.theta_i});
}

void PrintSummary(const FitReport& report) {
  const FitInfo& fit = report.fit;
  const SolverSummary& summary = report.summary;
  std::cout << Describe(VerdictOn(report));
  PrintLine("fitted       " + fit.source + ", " + std::to_string(fit.valid_samples) +
            " samples up to " + Text(fit.max_angle) + " deg, by " + FormText(report));
  std::cout << "solver       " << summary.solver << ": " << summary.iterations << " iterations, "
            << EndText(summary.stop_reason) << "; E is "
            << Text(100 * RelativeTo(report.black_objective, summary.final_objective), 3)
            << " % of a black model's";
  if (summary.diagnosis) {
    std::cout << ", its scaled gradient " << Text(summary.diagnosis->optimality, 2);
  }
  std::cout << "\n";
  if (!report.finished.steps.empty()) {
    PrintLine("finished     E is " + Text(100 * report.score.relative_objective, 3) + " %, after " +
              FinishedText(report));
  }
  if (report.azimuths) {
    PrintLine(std::string("azimuths     ") +
              (report.azimuths->matter ? "anisotropic: " : "isotropic: ") + report.azimuths->why);
  }
  if (report.nodes && report.nodes->chosen > 0) {
    const Candidate &coarsest = report.nodes->tried.front(),
                    &chosen = report.nodes->tried[report.nodes->chosen];
    PrintLine("nodes        " + chosen.name + ": E of directions held out is " +
              Text(100 * chosen.E, 3) + " % on these, " + Text(100 * coarsest.E, 3) + " % on " +
              coarsest.name);
  }
  if (report.finished.too_few_to_choose > 0) {
    PrintLine("note         no form was chosen, which takes " +
              std::to_string(report.finished.too_few_to_choose) +
              " samples or more; this is the default form");
  }
  if (report.held_out) {
    const HeldOutError& held_out = *report.held_out;
    PrintLine("held out     fitted without " + std::to_string(held_out.samples) +
              " samples, E of these is " + Text(100 * held_out.relative_objective, 3) +
              " % of a black model's, Delta E " + Text(held_out.mean_delta_e, 2));
  }
  if (report.bands) PrintLine("spectra      " + Describe(*report.bands, report.bands_seen));
  if (report.appearance) std::cout << DescribeBriefly(*report.appearance);
  if (report.reach) std::cout << ReachText(*report.reach);
}

void PrintSeconds(const FitReport& report) {
  const FitReport::Seconds& seconds = report.seconds;
  double total = 0;
  std::string parts;
  for (const auto& [name, part] : {std::pair{"reading", seconds.read},
                                   {"preparing", seconds.prepare},
                                   {"starting", seconds.init},
                                   {"choosing nodes", seconds.nodes},
                                   {"solving", seconds.solve},
                                   {"finishing", seconds.finish},
                                   {"fitting wavelengths", seconds.bands},
                                   {"comparing", seconds.score},
                                   {"fitting without held-out samples", seconds.held_out},
                                   {"drawing", seconds.draw}}) {
    // Rounded before they are summed, so that what is printed adds up.
    const double rounded = std::round(100 * part) / 100;
    total += rounded;
    if (rounded > 0) parts += (parts.empty() ? "" : ", ") + Hundredths(rounded) + " " + name;
  }
  std::cout << "seconds      " << Hundredths(total) << (parts.empty() ? "" : ": ") << parts << "\n";
}

}  // namespace trilobe
