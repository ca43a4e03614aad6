#include "fit/prune/lobe_search.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <string>
#include <utility>

#include "model/objective/lobes.h"
#include "solvers/joint/joint_step.h"
#include "solvers/starts/start_elimination.h"
#include "trilobe/core/base/stop_check.h"

namespace trilobe {
namespace {

// A lobe less may cost hardly more than the budget, so the samples are less thin than in `auto`.
constexpr StartElimination::Thinning kThinning{.samples_per_parameter = 100, .max_stride = 8};
// Steps of each start on thinned samples, and of the best two, so many at a time.
constexpr int kFirstTries = 3, kLeg = 3, kLastTries = 12;
// Most steps on all samples.
constexpr int kMaxTries = 40;
// A fit is given up when at its present pace it needs more steps than this to come down to its
// goal.
constexpr int kPatience = 12;

// The layout without the tables of the lobe `gone`; those of `heir` have its nodes besides their
// own.
TableLayout LayoutWithout(const ModelSpec& spec, const TableLayout& layout, int gone, int heir) {
  TableLayout fewer = layout;
  for (const Factor factor : kFactors) {
    if (!spec.sharing(factor).per_lobe) continue;
    auto& tables = fewer.nodes[static_cast<int>(factor)];
    const int each = spec.sharing(factor).per_channel ? kChannels : 1;
    for (int c = 0; c < each; ++c) {
      std::vector<int> both;
      std::ranges::set_union(layout.of(factor, spec.table(factor, heir, c)),
                             layout.of(factor, spec.table(factor, gone, c)),
                             std::back_inserter(both));
      tables[spec.table(factor, heir, c)] = std::move(both);
    }
    const auto begin = tables.begin() + spec.table(factor, gone, 0);
    tables.erase(begin, begin + each);
  }
  return fewer;
}

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

std::vector<TableLayout> LayoutsWithOneLobeLess(const ModelSpec& spec, const TableLayout& layout) {
  std::vector<TableLayout> layouts;
  for (int m = 0; m < spec.lobes; ++m) layouts.push_back(LayoutWithout(spec, layout, m, m));
  for (int m = 0; m < spec.lobes; ++m) {
    for (int other = m + 1; other < spec.lobes; ++other) {
      layouts.push_back(LayoutWithout(spec, layout, other, m));
    }
  }
  return layouts;
}

FittedModel FitFrom(const std::vector<FactorModel>& starts, const Objective& objective,
                    const FitGoal& goal, const StopCheck& stop,
                    std::span<const TableLayout> layouts) {
  std::vector<Reduction> stored;
  for (const TableLayout& layout : layouts) stored.emplace_back(objective.spec(), layout);
  const auto stored_of = [&](int start) { return stored.empty() ? nullptr : &stored[start]; };
  PhaseSeconds phases;
  FactorModel best = starts.front();
  int start = 0;
  {
    StartElimination elimination(objective, kThinning, stop);
    // They come from fits, so their magnitudes need no sweeps.
    for (int k = 0; k < static_cast<int>(starts.size()); ++k) {
      elimination.Enter(
          std::to_string(k), [&starts, k](PhaseSeconds*) { return std::optional(starts[k]); },
          {.count = 0}, stored_of(k));
    }
    elimination.Advance(kFirstTries);
    if (elimination.leader() == nullptr) return {best, objective.Value(best)};
    elimination.Keep(2);
    double E = elimination.Results().front().objective;
    bool hopeless = false;
    for (int tries = kFirstTries + kLeg; tries <= kLastTries && !hopeless; tries += kLeg) {
      elimination.Advance(tries);
      const double before = std::exchange(E, elimination.Results().front().objective);
      hopeless = E > goal.E + kPatience * (before - E) / kLeg;
    }
    best = *elimination.leader();
    start = std::stoi(elimination.Results().front().name);
    if (hopeless) return {best, objective.Value(best), start};
  }
  JointStepper stepper(
      objective, JointStepper::Curvature::kByProgress,
      stored.empty() ? JointStepper::Trial::kProjected : JointStepper::Trial::kAsItIs, &phases,
      stored_of(start));
  stepper.Restart(best);
  for (int tries = 0; tries < kMaxTries && !stepper.exhausted() && !stop(); ++tries) {
    const double before = stepper.E();
    if (!stepper.Step()) continue;
    const double decrease = before - stepper.E();
    if (stepper.E() > goal.E + kPatience * decrease) break;
    if (stepper.E() <= goal.E && decrease < goal.least_gain * before) break;
  }
  return {stepper.current(), stepper.E(), start};
}

}  // namespace trilobe
