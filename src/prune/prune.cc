#include "prune/prune.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lobes/gauge.h"
#include "lobes/lobes.h"
#include "prune/lobe_search.h"
#include "prune/needed_layout.h"
#include "prune/prune_tables.h"
#include "prune/pruning.h"
#include "prune/shapes.h"
#include "solvers/joint/reduction.h"

namespace trilobe {
namespace {

// Where lobes that went took more than this share of the budget, it may be better spent on nodes.
constexpr double kDear = 0.5;

// Towards a limit of the error: so often, and by this factor, the rise of E that is allowed grows.
constexpr int kStretches = 4;
constexpr double kStretch = 3;
constexpr double kLittleMore = 1.25;

// The first shape that changes no parameter.
void ShareWhatIsEqual(Pruning* pruning) {
  const PruneState& state = pruning->state();
  for (const ModelShape& shape : ShapesWithin(state.spec(), state.layout, pruning->options().colour,
                                              pruning->options().shadowing)) {
    if (shape.constant_G || shape.name.empty()) continue;
    const Reduction sharing = Reduction::BySharing(state.spec(), shape.spec);
    const Reduction reduction =
        sharing.After(Reduction(shape.spec, LayoutOf(shape, TableLayout::Full(shape.spec))));
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
  const TableLayout needed = NeededLayout(next.model, next.objective->coverage(),
                                          pruning->may_thin(), /*drop_equal=*/true);
  for (int f = 0; f < 3; ++f) next.layout.nodes[f] = needed.nodes[f];
  if (next.num_parameters() == pruning->state().num_parameters()) return;
  ExpandStored(next.layout, &next.model);
  next.E = next.data->Value(next.model);
  pruning->Decide("entries without data and runs of equal entries not stored", std::move(next),
                  true, "they change no value");
}

// The best that comes of these starts. Those whose lobes are stretched by others are fitted apart.
PruneState FitLobes(std::vector<FactorModel> starts, double wanted, const Pruning& pruning) {
  PruneState best{};
  while (!starts.empty() && !(best.objective != nullptr && pruning.options().stop())) {
    const ModelSpec spec = starts.front().spec();
    const auto others =
        std::stable_partition(starts.begin(), starts.end(),
                              [&](const FactorModel& start) { return start.spec() == spec; });
    const std::vector<FactorModel> alike(starts.begin(), others);
    starts.erase(starts.begin(), others);
    PruneState next = pruning.StateFor(spec);
    FittedModel fitted =
        FitFrom(alike, *next.objective, pruning.ForFits(wanted), pruning.options().stop);
    next.model = std::move(fitted.model);
    next.E = fitted.E;
    if (best.objective == nullptr || !(best.E <= next.E)) best = std::move(next);
  }
  return best;
}

// Tries the next number of lobes; true if it was taken.
bool TryLobes(const std::vector<FactorModel>& starts, double wanted, Pruning* pruning) {
  const PruneState& state = pruning->state();
  PruneState next = FitLobes(starts, wanted, *pruning);
  const int lobes = next.model.spec().lobes;
  NormalizeScale(next.objective->coverage(), &next.model);
  next.layout = NeededLayout(next.model, next.objective->coverage(), pruning->may_thin(),
                             /*drop_equal=*/true);
  ExpandStored(next.layout, &next.model);
  next.E = next.data->Value(next.model);
  if (pruning->options().stop()) return false;
  const bool within = next.E <= wanted && pruning->Keeps(next);
  const bool taken = lobes > state.lobes() ? next.E < state.E : within;
  const std::string what = LobesText(lobes) + " instead of " + LobesText(state.lobes());
  const std::string why = pruning->Against(next.E, within);
  return pruning->Decide(what, std::move(next), taken, why);
}

// Whether less than half of what the error may grow is spent, where it is limited.
bool SparesError(const Pruning& pruning) {
  // Half of the budget: of decibels, or of an error that is seen.
  const double half = pruning.options().error
                          ? (pruning.full_error() + pruning.max_error()) / 2
                          : std::sqrt(pruning.full_error() * pruning.max_error());
  return pruning.ErrorOf(pruning.state()) < half;
}

// Shape and nodes.
void ThinWithin(double limit, Pruning* pruning) {
  // Of an error that is seen, E tells little: a few nodes more are tried in any case.
  const double least = pruning->options().error ? kLittleMore : 1;
  pruning->set_search_limit(
      std::min(pruning->limit(), std::max(limit, least * pruning->state().E)));
  ChooseShape(pruning);
  ThinTables(pruning);
  if (!pruning->limits_error()) return;
  for (int round = 0; round < kStretches && SparesError(*pruning); ++round) {
    if (pruning->search_limit() >= pruning->limit()) return;
    pruning->set_search_limit(
        std::min(pruning->limit(),
                 pruning->E_full() + kStretch * (pruning->search_limit() - pruning->E_full())));
    ThinTables(pruning);
  }
}

// With as few lobes as the budget allows; and with one more where that took most of it.
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
    if (!TryLobes(WithOneLobeLess(state.model), wanted, pruning)) break;
    last_lobe = pruning->decisions().size() - 1;
    dear = pruning->options().error
               ? !SparesError(*pruning)
               : state.E - pruning->E_full() > kDear * (wanted - pruning->E_full());
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

void AddLobes(Pruning* pruning) {
  const PruneState& state = pruning->state();
  while (!pruning->Keeps(state) && state.lobes() < pruning->options().max_lobes) {
    const std::vector<FactorModel> starts = WithOneLobeMore(state.model);
    if (starts.empty() || !TryLobes(starts, pruning->search_limit(), pruning)) break;
  }
  if (!pruning->Keeps(state)) {
    pruning->Record("nothing else left out", state, false,
                    "the budget asks for a better fit than was found");
  } else {
    ChooseShape(pruning);
    ThinTables(pruning);
  }
}

// The lowest E that max_parameters reach: with as many lobes as there are, then with fewer as long
// as that is better.
void MeetParameters(Pruning* pruning) {
  const PruneState& state = pruning->state();
  while (state.num_parameters() <= pruning->options().max_parameters &&
         state.lobes() < pruning->options().max_lobes) {
    const std::vector<FactorModel> starts = WithOneLobeMore(state.model);
    if (starts.empty() || !TryLobes(starts, 0, pruning)) break;
  }
  if (state.num_parameters() <= pruning->options().max_parameters) return;
  PruneState lobes_kept = state;
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
    if (!TryLobes(WithOneLobeLess(state.model), met ? best.E : kInfinity, pruning)) {
      back_to_best();
      break;
    }
    lobes_kept = state;
    ChooseShape(pruning);
    ThinTables(pruning);
    const bool meets = state.num_parameters() <= pruning->options().max_parameters;
    if (met && !(meets && state.E < best.E)) {
      back_to_best();
      break;
    }
  }
  if (state.num_parameters() > pruning->options().max_parameters) {
    pruning->Record("nothing else left out", state, false,
                    "what may be left out does not reach the budget");
  }
}

}  // namespace

PrunedModel Prune(const Objective& measured, const Objective& with_prior, const FactorModel& full,
                  const PruneOptions& options) {
  Pruning pruning(measured, with_prior, full, options);
  LeaveOutWhatIsFree(&pruning);
  if (pruning.by_parameters()) {
    MeetParameters(&pruning);
  } else if (!pruning.Keeps(pruning.state())) {
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
