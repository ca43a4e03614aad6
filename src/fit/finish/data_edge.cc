#include "fit/finish/data_edge.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <span>
#include <vector>

#include "model/objective/beyond_data.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/reduction.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {
namespace {

constexpr int kMaxTied = 8;
constexpr double kRunaway = 5;
constexpr int kLookedAt = 5;
constexpr int kSteps = 12;
constexpr double kSmallDecrease = 1e-3;
constexpr double kMaxRise = 0.05;

// First of the observed entries [0, end) that are to be tied because few samples read them; `end`
// if the data go on to the end of the table.
int FirstUncovered(std::span<const double> coverage, int end) {
  if (end == static_cast<int>(coverage.size())) return end;
  int first = end;
  while (end - first < kMaxTied && first > 0 && !IsWellCovered(coverage, first - 1)) --first;
  return first;
}

// First entry that runs away: the first in the last third that is several times the median of those
// before it; `end` if none does.
int FirstRunaway(std::span<const double> table, int end) {
  for (int k = std::max(2 * end / 3, kLookedAt); k < end; ++k) {
    std::vector<double> before(table.begin() + k - kLookedAt, table.begin() + k);
    std::ranges::nth_element(before, before.begin() + kLookedAt / 2);
    if (table[k] > kRunaway * before[kLookedAt / 2] && before[kLookedAt / 2] > 0) return k;
  }
  return end;
}

enum class Rule { kBoth, kCoverage };

// Number of entries of a table that remain, from the first on, when those at its end are tied; all
// if none is to be tied.
int NumKept(Rule rule, std::span<const double> coverage, std::span<const double> table) {
  const auto size = static_cast<int>(coverage.size());
  const auto unobserved = [&](int entry) { return !(coverage[entry] > 0); };
  int end = size;
  while (end > 0 && unobserved(end - 1)) --end;
  int kept = FirstUncovered(coverage, end);
  if (rule == Rule::kBoth) kept = std::min(kept, FirstRunaway(table, end));
  if (kept == end) return size;
  // An unobserved one has nothing to tell the others.
  while (kept > 0 && unobserved(kept - 1)) --kept;
  return kept > 0 ? kept : size;
}

// Ties the ends of the tables of these factors. True if there was something to tie, and E came
// back.
bool Tie(Rule rule, std::initializer_list<Factor> factors, const Objective& objective,
         const StopCheck& stop, TieRefit refit, FactorModel* model) {
  if (stop()) return false;
  const ModelSpec& spec = model->spec();
  TableLayout layout = TableLayout::Full(spec);
  bool any = false;
  for (const Factor factor : factors) {
    if (spec.axis(factor).polar()) continue;  // nodes end where data do
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto coverage = std::span(objective.coverage())
                                .subspan(model->TableOffset(factor, t), spec.table_size(factor));
      const int kept = NumKept(rule, coverage, model->table(factor, t));
      if (kept == spec.table_size(factor)) continue;
      any = true;
      // The others follow, unobserved ones too, as they do beyond the last node of a layout.
      layout.of(factor, t).resize(kept);
    }
  }
  if (!any) return false;

  const double enough = (1 + kMaxRise) * objective.Value(*model);
  FactorModel tied = *model;
  ExpandStored(layout, &tied);
  const Reduction reduction(spec, layout);
  PhaseSeconds phases;
  JointStepper stepper(objective, JointStepper::Curvature::kByProgress,
                       JointStepper::Trial::kAsItIs, &phases, &reduction);
  stepper.Restart(tied);
  for (int step = 0; step < kSteps && !stepper.exhausted() && !stop(); ++step) {
    const double before = stepper.E();
    if (!stepper.Step()) continue;
    if (refit == TieRefit::kUntilBack && stepper.E() <= enough) break;
    const double decrease = before - stepper.E();
    // The same decrease in each step that is left would not bring E back.
    const bool hopeless = stepper.E() - (kSteps - 1 - step) * decrease > enough;
    if (hopeless || decrease < kSmallDecrease * before) break;
  }
  if (!(stepper.E() <= enough)) return false;
  *model = stepper.current();
  return true;
}

}  // namespace

bool TieEntriesAtDataEdge(const Objective& objective, FactorModel* model, const StopCheck& stop,
                          TieRefit refit) {
  CheckSameSpec(model->spec(), objective.spec());
  CheckParameters(*model);
  // If tying raises E too much, less is tried: at least nodes of G beyond the data, which only the
  // spline reads.
  const auto tie = [&](Rule rule, std::initializer_list<Factor> factors) {
    return Tie(rule, factors, objective, stop, refit, model);
  };
  return tie(Rule::kBoth, {Factor::kD, Factor::kF, Factor::kG}) ||
         tie(Rule::kCoverage, {Factor::kD, Factor::kF, Factor::kG}) ||
         tie(Rule::kCoverage, {Factor::kG});
}

TableLayout UntiedEntries(std::span<const double> coverage, const FactorModel& model) {
  CheckCoverage(coverage, model);
  constexpr double kRounding = 1e-12;
  const ModelSpec& spec = model.spec();
  TableLayout layout = TableLayout::Full(spec);
  for (const Factor factor : kFactors) {
    if (spec.axis(factor).polar()) continue;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto table = model.table(factor, t);
      const auto of_table = coverage.subspan(model.TableOffset(factor, t), table.size());
      int end = spec.table_size(factor);
      while (end > 0 && !(of_table[end - 1] > 0)) --end;
      int kept = end;
      while (kept > 1 && of_table[kept - 2] > 0 &&
             std::abs(table[kept - 1] - table[kept - 2]) <= kRounding * table[kept - 2]) {
        --kept;
      }
      if (kept < end) layout.of(factor, t).resize(kept);
    }
  }
  return layout;
}

}  // namespace trilobe
