#include "fit/reports/fit_report.h"

#include <algorithm>
#include <string>
#include <tuple>

#include "fit/reports/print.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/start/initial_model.h"

namespace trilobe {
namespace {

// Where --model=auto would have chosen among forms.
bool MayChooseForm(const FitReport& report) {
  const bool of_table = report.appearance && !report.appearance->at_nodes;
  const bool named_start = std::ranges::find(InitialModels(), report.fit.init,
                                             &InitialModel::name) != InitialModels().end();
  return of_table && named_start && report.finished.candidates.empty() &&
         ModelName(report.spec) == "shared" && report.spec.lobes >= ModelSpec().lobes;
}

}  // namespace

void TellFit(const FitResult& fit, FitReport* report) {
  report->interrupted = fit.interrupted;
  report->spec = fit.model().spec();
  report->summary = fit.summary;
  report->nodes = fit.nodes;
  report->prior = fit.prior;
  report->finished = fit.finished;
  report->stored_parameters = fit.stored_parameters;
  report->score = fit.score;
  report->appearance = fit.appearance;
  report->samples_seen = fit.samples_seen;
  report->left_out = fit.left_out;
  report->reach = fit.reach;
  report->light = fit.light;
  static_cast<FitResult::Seconds&>(report->seconds) = fit.seconds;
}

std::string ModelName(const ModelSpec& spec) {
  if (spec.anisotropic()) return "anisotropic";
  const auto is = [&spec](const ModelSpec& named) {
    return std::tie(spec.lobes, spec.D, spec.F, spec.G) ==
           std::tie(named.lobes, named.D, named.F, named.G);
  };
  if (is(ModelSpec::SharedFactors(spec.lobes))) return "shared";
  if (is(ModelSpec::IndependentG()) && !spec.stretches.any()) return "independent";
  return "other";
}

std::string ParametersText(const FitReport& report) {
  const int all = report.spec.num_parameters();
  std::string text = std::to_string(all) + " parameters";
  if (report.stored_parameters < all) {
    text += ", " + std::to_string(report.stored_parameters) + " of them stored";
  }
  return text;
}

std::string ReachText(const Reach& reach) {
  constexpr double kNotable = 2;
  if (std::max(reach.between, reach.beyond) < kNotable) return "";
  const auto times = [](double x) { return Text(x, 3) + " times the largest measured value"; };
  std::string text = "reach        ";
  if (reach.beyond >= kNotable) {
    text += "beyond " + Text(RadiansToDegrees(reach.max_theta), 3) +
            " deg, where nothing was measured, the model reaches " + times(reach.beyond);
  }
  if (reach.between >= kNotable) {
    text += (reach.beyond >= kNotable ? "; between the samples "
                                      : "between the samples the model reaches ") +
            times(reach.between);
  }
  return text + "\n";
}

ReportedVerdict VerdictOn(const FitReport& report) {
  const StopReason reason = report.summary.stop_reason;
  return MakeVerdict(
      report.appearance, report.samples_seen,
      {.interrupted = report.interrupted,
       .ended = reason != StopReason::kMaxIterations && reason != StopReason::kMaxSeconds &&
                reason != StopReason::kInterrupted,
       .may_choose_form = MayChooseForm(report),
       .default_solver = report.summary.solver == Solvers().front().name,
       .irreducible = IrreducibleShare(report.score),
       .left_out = report.left_out,
       .reach_beyond = report.reach ? report.reach->beyond : 0});
}

}  // namespace trilobe
