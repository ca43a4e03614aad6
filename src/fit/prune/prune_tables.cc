#include "fit/prune/prune_tables.h"

#include <algorithm>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "fit/prune/node_elimination.h"
#include "fit/prune/reduced_quadratic.h"
#include "fit/prune/stored_layouts.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/reduction.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/solvers/run.h"

namespace trilobe {
namespace {

// Refits of the remaining parameters end when a step gains less than kSmallGain of the budget, or
// kSmallOfE of E for a budget of parameters; and when kHope times the last gain would not bring E
// down to the budget.
constexpr int kMaxPolish = 8, kMaxPolishByParameters = 3, kHope = 4;
constexpr double kSmallGain = 0.02, kSmallOfE = 1e-4;

// Nodes are given up and the others refitted, again and again from the result: the part of the
// budget that errors of the quadratic leave is spent the next time. If they were too large, a
// smaller part is tried, which grows again. Ends when all that is left buys few parameters.
constexpr int kMaxAttempts = 8;
constexpr double kMinCut = 0.1, kMaxCut = 0.6, kGrowth = 1.5;
constexpr double kFewParameters = 0.04, kFirstBite = 0.25;

// For a budget of parameters: share of the excess that is removed at once, if that is more than
// kFewInExcess.
constexpr double kExcessAtOnce = 0.9;
constexpr int kFewInExcess = 10;

EliminationLimits LimitsFor(const Pruning& pruning, double E, int parameters) {
  EliminationLimits limits;
  limits.max_rise = pruning.by_parameters() ? kInfinity : pruning.search_limit() - E;
  limits.max_count = pruning.by_parameters()
                         ? std::max(parameters - pruning.options().max_parameters, 0)
                         : parameters;
  limits.may_thin = pruning.may_thin();
  return limits;
}

// Fits the parameters of the state's layout.
void Polish(const Pruning& pruning, PruneState* state) {
  const Reduction reduction(state->spec(), state->layout);
  PhaseSeconds phases;
  JointStepper stepper(*state->objective, JointStepper::Curvature::kByProgress,
                       JointStepper::Trial::kAsItIs, &phases, &reduction);
  stepper.Restart(state->model);
  const double small = pruning.by_parameters()
                           ? kSmallOfE * state->E
                           : kSmallGain * (pruning.search_limit() - pruning.E_base());
  const int most = pruning.by_parameters() ? kMaxPolishByParameters : kMaxPolish;
  for (int step = 0; step < most && !stepper.exhausted(); ++step) {
    if (pruning.options().stop()) break;
    const double before = stepper.E();
    if (!stepper.Step()) continue;
    const double decrease = before - stepper.E();
    const bool hopeless =
        !pruning.by_parameters() &&
        state->Judged(stepper.current(), stepper.E()) - kHope * decrease > pruning.search_limit();
    if (decrease < small || hopeless) break;
  }
  state->model = stepper.current();
  state->E = state->Judged(state->model, stepper.E());
}

bool WithinBudget(const Pruning& pruning, const PruneState& next) {
  return pruning.by_parameters() ||
         (next.E <= pruning.search_limit() && pruning.KeepsToBudget(next));
}

// A shape, with the parameters that are best by the quadratic.
struct ShapeOption {
  ModelShape shape;
  TableLayout layout;
  FactorModel model;
  double E = 0;            // once nodes are given up too, predicted
  int num_parameters = 0;  // then
};

// Predicted result of a shape; nothing if it is beyond the budget.
std::optional<ShapeOption> Promise(const Pruning& pruning, const ModelShape& shape,
                                   const QuadraticModel& at) {
  const PruneState& state = pruning.state();
  const std::span<const double> x = state.model.parameters();
  const Reduction sharing = Reduction::BySharing(state.spec(), shape.spec);
  ShapeOption option{.shape = shape, .layout = {}, .model = FactorModel(shape.spec)};
  double rise = 0;
  if (shape.name.empty()) {  // as it is
    option.layout = LayoutOf(shape, state.layout);
    option.model = state.model;
  } else {
    const std::vector<double> coverage = sharing.Transpose(state.objective->coverage());
    option.layout = LayoutOf(shape, NeededLayout(option.model, coverage, pruning.may_thin(),
                                                 /*drop_equal=*/false));
    const Reduction inner(shape.spec, option.layout), reduction = sharing.ComposedWith(inner);
    std::vector<double> y0 = reduction.Transpose(x);
    const std::vector<double> counts = reduction.Transpose(std::vector<double>(x.size(), 1.0));
    for (size_t j = 0; j < y0.size(); ++j) y0[j] /= counts[j];
    const ReducedPoint best = LowestWithin(reduction, at, x, y0, state.lobes());
    rise = best.rise;
    std::ranges::copy(inner.Expand(best.y), option.model.parameters().begin());
  }
  option.E = state.E + rise;
  if (!pruning.by_parameters() && option.E > pruning.search_limit()) return std::nullopt;

  // The quadratic of the shape's parameters, moved there.
  QuadraticModel there = sharing(at);
  const std::vector<double> moved = sharing.Expand(option.model.parameters());
  std::vector<double> gradient = GradientChange(at, x, moved);
  for (size_t k = 0; k < x.size(); ++k) gradient[k] += at.gradient[k];
  there.gradient = sharing.Transpose(gradient);
  option.num_parameters = option.layout.num_parameters(shape.spec);
  const std::vector<Elimination> order = OrderOfElimination(
      there, option.model, option.layout, LimitsFor(pruning, option.E, option.num_parameters));
  if (!order.empty()) option.E += order.back().rise;
  option.num_parameters -= static_cast<int>(order.size());
  return option;
}

// The state with the first `count` nodes given up, refitted.
PruneState RemoveNodes(const Pruning& pruning, const std::vector<Elimination>& order, int count,
                       const QuadraticModel& at) {
  PruneState next = pruning.state();
  for (int k = 0; k < count; ++k) {
    std::erase(next.layout.of(order[k].factor, order[k].table), order[k].entry);
  }
  const Reduction reduction(next.spec(), next.layout);
  const std::vector<double> y0 = reduction.Restrict(pruning.state().model.parameters());
  const ReducedPoint best =
      LowestWithin(reduction, at, pruning.state().model.parameters(), y0, pruning.state().lobes());
  next.E = kInfinity;
  for (const std::vector<double>& y : {best.y, y0}) {
    FactorModel model(next.spec());
    std::ranges::copy(reduction.Expand(y), model.parameters().begin());
    const double E = next.objective->Value(model);
    if (!(E < next.E)) continue;
    next.E = E;
    next.model = model;
  }
  Polish(pruning, &next);
  return next;
}

// Number of eliminations with a rise of at most `rise`, at least 1.
int CountWithin(const std::vector<Elimination>& order, double rise) {
  const auto end = std::ranges::upper_bound(order, rise, {}, &Elimination::rise);
  return std::max(1, static_cast<int>(end - order.begin()));
}

// Share of the way from one state to another, beyond the budget, that keeps to it: E rises evenly
// along the way, and so does the square of an error.
double ShareWithin(const Pruning& pruning, const PruneState& from, const PruneState& next) {
  const double of_E = (pruning.search_limit() - from.E) / (next.E - from.E);
  if (!pruning.limits_error()) return of_E;
  const double before = pruning.ErrorOf(from), after = pruning.ErrorOf(next);
  const double most = pruning.max_error();
  if (!(after > most)) return of_E;
  const double of_error = (most * most - before * before) / (after * after - before * before);
  return next.E > pruning.search_limit() ? std::min(of_E, of_error) : of_error;
}

// Gives up nodes as long as many go at once.
void ThinQuickly(Pruning* pruning) {
  const bool by_parameters = pruning->by_parameters();
  // Share of the remaining budget to spend next: less if predictions are too low, as for visible
  // errors.
  double share = pruning->options().error ? kFirstBite : 1;
  for (int attempt = 0; attempt < kMaxAttempts && !pruning->options().stop();) {
    const PruneState from = pruning->state();
    const QuadraticModel& at = pruning->Linearized();
    const std::vector<Elimination> order = OrderOfElimination(
        at, from.model, from.layout, LimitsFor(*pruning, from.E, from.num_parameters()));
    int count = static_cast<int>(order.size());
    if (by_parameters && count > kFewInExcess) count = static_cast<int>(kExcessAtOnce * count);
    const double left = pruning->search_limit() - from.E;
    bool worth_more = false;
    for (bool taken = false; !taken && attempt < kMaxAttempts && count > 0; ++attempt) {
      if (share < 1) count = std::min(count, CountWithin(order, share * left));
      PruneState next = RemoveNodes(*pruning, order, count, at);
      taken = WithinBudget(*pruning, next);
      if (taken) {
        const bool few = next.num_parameters() > (1 - kFewParameters) * from.num_parameters();
        worth_more = by_parameters || share < 1 || !few;
        share = std::min(1.0, kGrowth * share);
        pruning->GoOnFrom(std::move(next));
      } else {
        share *= std::clamp(ShareWithin(*pruning, from, next), kMinCut, kMaxCut);
      }
    }
    if (!worth_more) return;
  }
}

// Gives up the nodes of a small model one by one: of those that raise E least, the one that is seen
// least.
void ThinSingly(Pruning* pruning) {
  constexpr int kSmall = 100, kTries = 5;
  while (pruning->state().num_parameters() <= kSmall) {
    const PruneState& from = pruning->state();
    const QuadraticModel& at = pruning->Linearized();
    const std::vector<Elimination> order = OrderOfElimination(at, from.model, from.layout,
                                                              {.max_rise = kInfinity,
                                                               .max_count = from.num_parameters(),
                                                               .may_thin = pruning->may_thin()});
    double least = pruning->max_error();
    std::optional<PruneState> best;
    for (int k = 0; k < kTries && k < static_cast<int>(order.size()); ++k) {
      if (pruning->options().stop()) return;
      PruneState next = RemoveNodes(*pruning, {order[k]}, 1, at);
      const double error = pruning->ErrorOf(next);
      if (!(error <= least && next.E <= pruning->limit())) continue;
      least = error;
      best = std::move(next);
    }
    if (!best) return;
    pruning->GoOnFrom(*std::move(best));
  }
}

// If an error is limited, E is only a guide. So the error grows in stages: what a tighter budget
// can do without, a looser one can, too.
void ThinByStages(Pruning* pruning) {
  constexpr double kStages[] = {0.4, 1};
  constexpr double kRoom = 3;  // for E, of what it is
  const double most = pruning->max_error(), least = pruning->ErrorOf(pruning->state());
  for (const double stage : kStages) {
    pruning->set_max_error(least + stage * (most - least));
    pruning->set_search_limit(
        std::min(pruning->limit(), std::max(pruning->search_limit(), kRoom * pruning->state().E)));
    ThinQuickly(pruning);
    ThinSingly(pruning);
  }
}

// Whether a shape leaves half of the error that is left to nodes, which use it better.
bool LeavesRoom(const Pruning& pruning, const PruneState& next) {
  if (!pruning.options().error) return true;
  return pruning.ErrorOf(next) <= (pruning.ErrorOf(pruning.state()) + pruning.max_error()) / 2;
}

}  // namespace

void ChooseShape(Pruning* pruning) {
  const PruneOptions& limits = pruning->options();
  if (!limits.sharing) return;
  const std::vector<ModelShape> shapes = ShapesWithin(
      pruning->state().spec(), pruning->state().layout, limits.colour, limits.shadowing);
  // The shape as it is has the most parameters, and comes last.
  if (shapes.front().name.empty()) return;
  const QuadraticModel& at = pruning->Linearized();
  std::vector<std::optional<ShapeOption>> promised(shapes.size());
  ParallelFor(static_cast<int>(shapes.size()), pruning->state().objective->num_threads(),
              [&](int k) { promised[k] = Promise(*pruning, shapes[k], at); });
  std::vector<ShapeOption> options;
  for (std::optional<ShapeOption>& option : promised) {
    if (!option) continue;
    // If no other shape is within the budget, the present one stays.
    if (option->shape.name.empty() && options.empty()) return;
    options.push_back(*std::move(option));
  }
  std::ranges::stable_sort(options, [&](const ShapeOption& a, const ShapeOption& b) {
    if (!pruning->by_parameters()) return a.num_parameters < b.num_parameters;
    const int excess_a = std::max(a.num_parameters - limits.max_parameters, 0);
    const int excess_b = std::max(b.num_parameters - limits.max_parameters, 0);
    return std::pair(excess_a, a.E) < std::pair(excess_b, b.E);
  });
  for (const ShapeOption& option : options) {
    if (option.shape.name.empty() || limits.stop()) return;
    PruneState next = pruning->StateFor(option.shape.spec);
    next.model = option.model;
    next.layout = option.layout;
    next.E = next.data->Value(next.model);
    Polish(*pruning, &next);
    const bool taken = WithinBudget(*pruning, next) && LeavesRoom(*pruning, next);
    const std::string why = pruning->CompareWithFull(next.E, taken);
    if (pruning->Decide(option.shape.name, std::move(next), taken, why)) return;
  }
}

void ThinTables(Pruning* pruning) {
  const PruneState before = pruning->state();
  if (pruning->options().error) {
    ThinByStages(pruning);
  } else {
    ThinQuickly(pruning);
  }
  if (pruning->state().num_parameters() == before.num_parameters()) return;
  PruneState after = pruning->GoOnFrom(before);
  std::ostringstream what;
  what << "nodes of";
  for (const Factor factor : kFactors) {
    size_t nodes_before = 0, nodes_after = 0;
    for (const auto& nodes : before.layout.nodes[static_cast<int>(factor)]) {
      nodes_before += nodes.size();
    }
    for (const auto& nodes : after.layout.nodes[static_cast<int>(factor)]) {
      nodes_after += nodes.size();
    }
    what << (factor == Factor::kD ? " " : ", ") << FactorName(factor) << " from " << nodes_before
         << " to " << nodes_after;
  }
  const std::string why = pruning->CompareWithFull(after.E, /*within=*/true);
  pruning->Decide(what.str(), std::move(after), true, why);
}

}  // namespace trilobe
