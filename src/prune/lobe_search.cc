#include "prune/lobe_search.h"

#include <optional>
#include <utility>

#include "lobes/lobes.h"
#include "solvers/joint/joint_step.h"
#include "solvers/multistart/start_elimination.h"
#include "trilobe/base/stop_check.h"

namespace trilobe {
namespace {

// A lobe less may cost hardly more than the budget, so the samples are less thin than in `auto`.
constexpr StartElimination::Thinning kThinning{.samples_per_parameter = 100, .max_stride = 8};
// Steps of each start on thinned samples, and of the best two, so many at a time.
constexpr int kFirstTries = 3, kLeg = 3, kLastTries = 12;
// On all samples.
constexpr int kMaxTries = 40;
// A fit is given up when at its present pace it needs more steps than this to come down to what is
// wanted, and ends when it is there and a step gains less than this.
constexpr int kPatience = 12;
constexpr double kSmallDecrease = 1e-4;

}  // namespace

std::vector<FactorModel> WithOneLobeLess(const FactorModel& canonical) {
  std::vector<FactorModel> models;
  const int lobes = canonical.spec().lobes;
  for (int m = 0; m < lobes; ++m) models.push_back(WithoutLobe(canonical, m));
  for (int m = 0; m < lobes; ++m) {
    for (int other = m + 1; other < lobes; ++other) {
      models.push_back(WithLobesMerged(canonical, m, other));
    }
  }
  return models;
}

std::vector<FactorModel> WithOneLobeMore(const FactorModel& canonical) {
  std::vector<FactorModel> models;
  const ModelSpec& spec = canonical.spec();
  if (!spec.D.per_lobe || spec.lobes == kMaxLobes) return models;
  for (int m = 0; m < spec.lobes; ++m) models.push_back(SplitLobe(canonical, m));
  return models;
}

FittedModel FitFrom(const std::vector<FactorModel>& starts, const Objective& objective,
                    double wanted, const StopCheck& stop) {
  PhaseSeconds phases;
  JointStepper stepper(objective, JointStepper::Curvature::kByProgress,
                       JointStepper::Trial::kProjected, &phases);
  {
    StartElimination elimination(objective, kThinning, stop);
    // They come from fits, so their magnitudes need no sweeps.
    for (const FactorModel& start : starts) {
      elimination.Enter("", [&start] { return std::optional(start); }, {.count = 0});
    }
    elimination.Advance(kFirstTries);
    if (elimination.leader() == nullptr) return {starts.front(), objective.Value(starts.front())};
    elimination.Keep(2);
    double E = elimination.Results().front().objective;
    for (int tries = kFirstTries + kLeg; tries <= kLastTries; tries += kLeg) {
      elimination.Advance(tries);
      const double before = std::exchange(E, elimination.Results().front().objective);
      if (E > wanted + kPatience * (before - E) / kLeg) {
        return {*elimination.leader(), objective.Value(*elimination.leader())};
      }
    }
    stepper.Restart(*elimination.leader());
  }
  for (int tries = 0; tries < kMaxTries && !stepper.exhausted() && !stop(); ++tries) {
    const double before = stepper.E();
    if (!stepper.Step()) continue;
    const double decrease = before - stepper.E();
    if (stepper.E() > wanted + kPatience * decrease) break;
    if (stepper.E() <= wanted && decrease < kSmallDecrease * before) break;
  }
  return {stepper.current(), stepper.E()};
}

}  // namespace trilobe
