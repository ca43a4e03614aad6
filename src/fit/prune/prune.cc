#include "fit/prune/prune.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fit/prune/lobe_search.h"
#include "fit/prune/prune_tables.h"
#include "fit/prune/pruning.h"
#include "fit/prune/stored_layouts.h"
#include "model/objective/gauge.h"
#include "model/objective/lobes.h"
#include "solvers/joint/reduction.h"

namespace trilobe {
namespace {

// If the removal of lobes took more than this share of the budget, nodes may be a better use of it.
constexpr double kDear = 0.5;

// Until the error reaches its limit, the allowed rise of E grows kStretches times by kStretch.
constexpr int kStretches = 4;
constexpr double kStretch = 3;
constexpr double kLittleMore = 1.25;

// Relative decrease of E that no picture shows.
constexpr double kLittleUnseen = 0.02;

// The first shape that changes no parameter.
void ShareWhatIsEqual(Pruning* pruning) {
  const PruneState& state = pruning->state();
  for (const ModelShape& shape : ShapesWithin(state.spec(), state.layout, pruning->options().colour,
                                              pruning->options().shadowing)) {
    if (shape.constant_G || shape.name.empty()) continue;
    const Reduction sharing = Reduction::BySharing(state.spec(), shape.spec);
    const Reduction reduction =
        sharing.ComposedWith(Reduction(shape.spec, LayoutOf(shape, TableLayout::Full(shape.spec))));
    const std::span<const double> x = state.model.parameters();
    if (!std::ranges::equal(reduction.Expand(reduction.Restrict(x)), x)) continue;
    FactorModel model(shape.spec);
    std::ranges::copy(sharing.Restrict(x), model.parameters().begin());
    PruneState next = pruning->MakeState(shape.spec, model);
    next.layout = LayoutOf(shape, std::move(next.layout));
    pruning->Decide(shape.name, std::move(next), true, "they are equal");
    return;
  }
}

// Lobes that reflect nothing, entries that no data touch and runs of equal values.
void LeaveOutWhatIsFree(Pruning* pruning) {
  if (pruning->options().lobes) {
    FactorModel model = pruning->state().model;
    for (int m = model.spec().lobes - 1; m >= 0; --m) {
      const auto s = model.s(m);
      if (std::ranges::all_of(s, [](double x) { return x == 0; })) model = WithoutLobe(model, m);
    }
    if (model.spec() != pruning->state().spec()) {
      PruneState next = pruning->MakeState(model.spec(), model);
      const std::string what =
          LobesText(next.lobes()) + " instead of " + LobesText(pruning->state().lobes());
      pruning->Decide(what, std::move(next), true, "the others reflect nothing");
    }
  }
  if (pruning->options().sharing) ShareWhatIsEqual(pruning);
  PruneState next = pruning->state();
  next.layout = NeededLayout(next.model, next.layout, next.objective->coverage(),
                             pruning->may_thin(), /*drop_equal=*/true);
  if (next.num_parameters() == pruning->state().num_parameters()) return;
  ExpandStored(next.layout, &next.model);
  next.E = next.data->Value(next.model);
  pruning->Decide("entries without data and runs of equal entries not stored", std::move(next),
                  true, "they change no value");
}

// Start of a fit of lobes, and what is stored of it.
struct LobeStart {
  FactorModel model;
  TableLayout layout;
};

std::vector<LobeStart> LobeStarts(std::vector<FactorModel> models) {
  std::vector<LobeStart> starts;
  for (FactorModel& model : models) {
    TableLayout all = TableLayout::Full(model.spec());
    starts.push_back({std::move(model), std::move(all)});
  }
  return starts;
}

// Starts with one lobe less; a model that came thinned keeps its nodes.
std::vector<LobeStart> WithOneLobeLess(const Pruning& pruning) {
  const PruneState& state = pruning.state();
  std::vector<LobeStart> starts = LobeStarts(WithOneLobeLess(state.model));
  if (!pruning.options().layout || state.lobes() < 2) return starts;
  std::vector<TableLayout> layouts = LayoutsWithOneLobeLess(state.spec(), state.layout);
  for (size_t k = 0; k < starts.size(); ++k) {
    starts[k].layout = std::move(layouts[k]);
    ExpandStored(starts[k].layout, &starts[k].model);
  }
  return starts;
}

// The best fit from these starts. Those whose lobes have other stretches are fitted apart.
PruneState FitLobes(std::vector<LobeStart> starts, double wanted, const Pruning& pruning) {
  FitGoal goal{.E = pruning.GoalOfFits(wanted)};
  // If E is only a guide to what is seen, the last of it is not worth its time.
  if (pruning.options().error) goal.least_gain = kLittleUnseen;
  PruneState best{};
  while (!starts.empty() && !(best.objective != nullptr && pruning.options().stop())) {
    const ModelSpec spec = starts.front().model.spec();
    const auto others =
        std::stable_partition(starts.begin(), starts.end(),
                              [&](const LobeStart& start) { return start.model.spec() == spec; });
    std::vector<FactorModel> models;
    std::vector<TableLayout> layouts;
    for (auto start = starts.begin(); start != others; ++start) {
      models.push_back(std::move(start->model));
      layouts.push_back(std::move(start->layout));
    }
    starts.erase(starts.begin(), others);
    const bool thinned = layouts.front() != TableLayout::Full(spec);
    PruneState next = pruning.StateFor(spec);
    FittedModel fitted = FitFrom(models, *next.objective, goal, pruning.options().stop,
                                 thinned ? std::span(layouts) : std::span<TableLayout>());
    next.model = std::move(fitted.model);
    next.layout = std::move(layouts[fitted.start]);
    next.E = fitted.E;
    if (best.objective == nullptr || !(best.E <= next.E)) best = std::move(next);
  }
  return best;
}

// Reason for trying one more lobe, and the outcome.
std::string WhyAdded(const Pruning& pruning, double E, bool taken, bool within) {
  const int lobes = pruning.state().lobes();
  const std::string reason = pruning.by_parameters()
                                 ? "the budget has room for more parameters"
                                 : "with " + LobesText(lobes) + " the budget is missed";
  const std::string comes_of_it =
      taken ? pruning.CompareWithFull(E, within) : "it brings the model hardly nearer to that";
  return reason + "; " + comes_of_it;
}

// Whether one more lobe takes a tenth off the excess over the budget, or lowers E if parameters are
// the budget.
bool IsWorthALobe(const Pruning& pruning, const PruneState& next) {
  constexpr double kShare = 0.1;
  if (pruning.by_parameters()) return next.E < pruning.state().E;
  const double cost = pruning.Cost(pruning.state());
  return cost - pruning.Cost(next) >= kShare * (cost - pruning.max_cost());
}

// Tries the next number of lobes; true if it was taken.
bool TryLobes(std::vector<LobeStart> starts, double wanted, Pruning* pruning) {
  const PruneState& state = pruning->state();
  PruneState next = FitLobes(std::move(starts), wanted, *pruning);
  const int lobes = next.model.spec().lobes;
  NormalizeScale(next.objective->coverage(), &next.model);
  next.layout = NeededLayout(next.model, next.layout, next.objective->coverage(),
                             pruning->may_thin(), /*drop_equal=*/true);
  ExpandStored(next.layout, &next.model);
  next.E = next.data->Value(next.model);
  if (pruning->options().stop()) return false;
  const bool within = next.E <= wanted && pruning->KeepsToBudget(next);
  const bool adds = lobes > state.lobes();
  const bool taken = adds ? IsWorthALobe(*pruning, next) : within;
  const std::string what = LobesText(lobes) + " instead of " + LobesText(state.lobes());
  const std::string why =
      adds ? WhyAdded(*pruning, next.E, taken, within) : pruning->CompareWithFull(next.E, within);
  return pruning->Decide(what, std::move(next), taken, why);
}

// Whether less than half of what the error may grow is spent, where it is limited.
bool SparesError(const Pruning& pruning) {
  // Half of the budget: of decibels, or of an error that is seen.
  const double half = pruning.options().error
                          ? (pruning.base_error() + pruning.max_error()) / 2
                          : std::sqrt(pruning.base_error() * pruning.max_error());
  return pruning.ErrorOf(pruning.state()) < half;
}

// Chooses the shape, then the nodes.
void ThinWithin(double limit, Pruning* pruning) {
  // E tells little about an error that is seen: a few nodes more are tried in any case.
  const double least = pruning->options().error ? kLittleMore : 1;
  pruning->set_search_limit(
      std::min(pruning->limit(), std::max(limit, least * pruning->state().E)));
  ChooseShape(pruning);
  ThinTables(pruning);
  if (!pruning->limits_error() || pruning->options().error) return;
  for (int round = 0; round < kStretches && SparesError(*pruning); ++round) {
    if (pruning->search_limit() >= pruning->limit()) return;
    pruning->set_search_limit(
        std::min(pruning->limit(),
                 pruning->E_base() + kStretch * (pruning->search_limit() - pruning->E_base())));
    ThinTables(pruning);
  }
}

// Thins with as few lobes as the budget allows; and with one more if that took most of it.
void SpendBudget(Pruning* pruning) {
  const PruneState& state = pruning->state();
  // The search limit says nothing about an error far away, so that E may rise beyond it here.
  const double limit = pruning->search_limit();
  const double wanted = pruning->limits_error() ? pruning->limit() : limit;
  PruneState with_one_more;
  bool dear = false;  // the last lobe
  size_t last_lobe = 0;
  while (pruning->options().lobes && state.lobes() > 0) {
    PruneState before = state;
    if (!TryLobes(WithOneLobeLess(*pruning), wanted, pruning)) break;
    last_lobe = pruning->decisions().size() - 1;
    dear = pruning->options().error
               ? !SparesError(*pruning)
               : state.E - pruning->E_base() > kDear * (wanted - pruning->E_base());
    with_one_more = std::move(before);
  }
  ThinWithin(limit, pruning);
  if (!dear || pruning->options().stop()) return;
  PruneState fewer = pruning->GoOnFrom(std::move(with_one_more));
  const size_t end = pruning->decisions().size();
  ThinWithin(limit, pruning);
  if (state.num_parameters() < fewer.num_parameters()) {
    pruning->Withdraw(last_lobe, end, "with one lobe more fewer parameters are enough");
  } else {
    pruning->GoOnFrom(std::move(fewer));
    pruning->Withdraw(end, pruning->decisions().size(),
                      "with one lobe less fewer parameters are enough");
  }
}

// For a budget that the full model misses. Where no number of lobes meets it, the smallest form is
// sought that is nearly as good as the best.
void AddLobes(Pruning* pruning) {
  const PruneState& state = pruning->state();
  while (!pruning->KeepsToBudget(state) && state.lobes() < pruning->options().max_lobes) {
    std::vector<LobeStart> starts = LobeStarts(WithOneLobeMore(state.model));
    if (starts.empty() || !TryLobes(std::move(starts), pruning->search_limit(), pruning)) break;
  }
  if (pruning->KeepsToBudget(state)) {
    ChooseShape(pruning);
    ThinTables(pruning);
    return;
  }
  pruning->Record(kWithinBudget, state, false, "none was found; " + std::string(kSoughtInstead));
  pruning->SettleForState();
  SpendBudget(pruning);
}

// The lowest E that max_parameters reach: with as many lobes as there are, then with fewer as long
// as that is better.
void MeetParameters(Pruning* pruning) {
  const PruneState& state = pruning->state();
  while (state.num_parameters() <= pruning->options().max_parameters &&
         state.lobes() < pruning->options().max_lobes) {
    std::vector<LobeStart> starts = LobeStarts(WithOneLobeMore(state.model));
    if (starts.empty() || !TryLobes(std::move(starts), 0, pruning)) break;
  }
  if (state.num_parameters() <= pruning->options().max_parameters) return;
  PruneState lobes_kept = state;
  size_t thinned = pruning->decisions().size();  // where it is decided what these lobes store
  ChooseShape(pruning);
  ThinTables(pruning);
  while (pruning->options().lobes && lobes_kept.lobes() > 0) {
    PruneState best = pruning->GoOnFrom(lobes_kept);
    const size_t decided = pruning->decisions().size();
    const bool met = best.num_parameters() <= pruning->options().max_parameters;
    const auto back_to_best = [&] {
      pruning->GoOnFrom(std::move(best));
      pruning->Withdraw(decided, pruning->decisions().size(), "with more lobes it ends lower");
    };
    if (!TryLobes(WithOneLobeLess(*pruning), met ? best.E : kInfinity, pruning)) {
      back_to_best();
      break;
    }
    lobes_kept = state;
    const size_t fewer = pruning->decisions().size();
    ChooseShape(pruning);
    ThinTables(pruning);
    const bool meets = state.num_parameters() <= pruning->options().max_parameters;
    if (met && !(meets && state.E < best.E)) {
      back_to_best();
      break;
    }
    pruning->Withdraw(
        thinned, decided,
        "with fewer lobes it ends " + std::string(met ? "lower" : "with fewer parameters"));
    thinned = fewer;
  }
  if (state.num_parameters() > pruning->options().max_parameters) {
    pruning->Record("all else", state, false, "what may be left out does not reach the budget");
  }
}

}  // namespace

PrunedModel Prune(const Objective& measured, const Objective& with_prior, const FactorModel& full,
                  const PruneOptions& options) {
  Pruning pruning(measured, with_prior, full, options);
  LeaveOutWhatIsFree(&pruning);
  if (pruning.by_parameters()) {
    MeetParameters(&pruning);
  } else if (!pruning.KeepsToBudget(pruning.state())) {
    AddLobes(&pruning);
  } else if (pruning.may_rise()) {
    SpendBudget(&pruning);
  }
  // The layout knows lobes by their places.
  return pruning.Result(LobeOrder::kAsTheyAre);
}

PrunedModel Prune(const Objective& objective, const FactorModel& full,
                  const PruneOptions& options) {
  return Prune(objective, objective, full, options);
}

}  // namespace trilobe
