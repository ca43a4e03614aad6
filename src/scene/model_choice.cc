#include "trilobe/scene/model_choice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/base/stopwatch.h"
#include "trilobe/math/catmull_rom.h"
#include "trilobe/model/gauge.h"
#include "trilobe/model/lobes.h"
#include "trilobe/scene/prune.h"
#include "trilobe/solvers/joint/data_edge.h"
#include "trilobe/solvers/joint/joint_step.h"
#include "trilobe/solvers/joint/reduction.h"
#include "trilobe/solvers/race/start_race.h"

namespace trilobe {
namespace {

// A form before thinning: what it is called, and where its fit begins.
struct Form {
  std::string name;
  FactorModel start;
};

// The same values with tables shared by less.
FactorModel SharingLess(const FactorModel& model, const ModelSpec& spec) {
  FactorModel result(spec);
  const Reduction repeat = Reduction::BySharing(spec, model.spec());
  std::ranges::copy(repeat.Expand(model.parameters()), result.parameters().begin());
  return result;
}

std::vector<Form> Forms(const FactorModel& fitted) {
  const ModelSpec& own = fitted.spec();
  std::vector<Form> forms;
  if (own.lobes > 1 && !own.F.per_lobe) {
    ModelSpec spec = own;
    spec.F.per_lobe = true;
    forms.push_back({"F by lobe", SharingLess(fitted, spec)});
  }
  if (own.lobes > 0 && !own.D.per_channel) {
    ModelSpec spec = own;
    spec.D.per_channel = true;
    forms.push_back({"D by channel", SharingLess(fitted, spec)});
  }
  if (own.lobes > 0 && own.lobes < kMaxLobes && own.D.per_lobe) {
    forms.push_back({"a lobe more", SplitLobe(fitted, StrongestLobe(fitted))});
  }
  return forms;
}

// Some joint steps on thinned samples, then on all. The start reflects as the fitted model does, so
// that few are enough.
FactorModel Fit(const Objective& objective, const FactorModel& start,
                const std::function<bool()>& stop) {
  constexpr StartRace::Thinning kThinned{.samples_per_parameter = 25, .max_stride = 24};
  constexpr int kStepsOnThinned = 12, kStepsOnAll = 2;
  StartRace race(objective, kThinned, stop);
  race.Enter("", [&start] { return std::optional(start); }, {.count = 0});
  race.Advance(kStepsOnThinned);
  PhaseSeconds phases;
  JointStepper stepper(objective, JointStepper::Curvature::kByProgress,
                       JointStepper::Trial::kProjected, &phases);
  stepper.Restart(race.leader() != nullptr ? *race.leader() : start);
  for (int k = 0; k < kStepsOnAll && !stepper.exhausted() && !stop(); ++k) stepper.Step();
  return stepper.current();
}

// The last observed entry of each G; that of the table where data go on to its end.
std::vector<int> LastLiveNodes(const Objective& objective) {
  const ModelSpec& spec = objective.spec();
  const FactorModel layout(spec);
  std::vector<int> last;
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    int node = spec.g_axis.size - 1;
    while (node > 0 && !(objective.coverage()[layout.TableOffset(Factor::kG, t) + node] > 0)) {
      --node;
    }
    last.push_back(node);
  }
  return last;
}

// A thinned G is constant beyond its last node, which makes the BRDF grow as 1 / cos^2 theta where
// no data are. Two more nodes, at the last observed entry and at the end, make it fall about as the
// cosine.
void ContinueShadowing(const std::vector<int>& last_live, PrunedModel* pruned) {
  const ModelSpec& spec = pruned->model.spec();
  const CatmullRom spline(spec.g_axis.size);
  const int end = spec.g_axis.size - 1;
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    const int last = last_live[t];
    std::vector<int>& nodes = pruned->layout.of(Factor::kG, t);
    if (last == end || nodes.front() > last) continue;
    while (nodes.back() > last) nodes.pop_back();
    const std::span<double> G = pruned->model.table(Factor::kG, t);
    if (nodes.back() != last) nodes.push_back(last);
    nodes.push_back(end);
    G[end] = G[last] * std::cos(spline.NodeAngle(end)) / std::cos(spline.NodeAngle(last));
  }
  ExpandStored(pruned->layout, &pruned->model);
  pruned->num_parameters = pruned->layout.num_parameters(spec);
}

}  // namespace

ChosenModel ChooseModel(const Objective& objective, const FactorModel& fitted,
                        const ModelChoiceOptions& options) {
  if (options.max_parameters < 1) throw Error("a budget of parameters must be at least 1");
  ChosenModel best;
  Stopwatch stopwatch;
  const auto judge = [&](const std::string& name, const FactorModel& model,
                         const TableLayout& layout, double E) {
    const double seconds = stopwatch.Lap();
    double score = options.judge(model);
    // Below all others, with which NaN has no order.
    if (std::isnan(score)) score = -std::numeric_limits<double>::infinity();
    best.candidates.push_back({.name = name,
                               .num_parameters = layout.num_parameters(model.spec()),
                               .E = E,
                               .score = score,
                               .seconds = seconds});
    stopwatch.Lap();
    return score;
  };
  // The last candidate, if it is the best that keeps to the budget.
  const auto choose = [&](const FactorModel& model, const TableLayout& layout) {
    const ModelCandidate& last = best.candidates.back();
    if (last.num_parameters > options.max_parameters) return;
    if (best.chosen >= 0 && !(last.score > best.candidates[best.chosen].score)) return;
    best.chosen = static_cast<int>(best.candidates.size()) - 1;
    best.model = model;
    best.layout = layout;
  };
  const auto thin = [&](const std::string& name, const Objective& of, const FactorModel& model) {
    const std::vector<int> last_live = LastLiveNodes(of);
    const auto continued = 2 * static_cast<int>(std::ranges::count_if(last_live, [&](int k) {
                             return k < of.spec().g_axis.size - 1;
                           }));
    PruneOptions prune;
    prune.lobes = prune.colour = false;
    // Not where next to nothing would be left.
    const bool continues = continued > 0 && options.max_parameters > 4 * continued;
    prune.max_parameters = options.max_parameters - (continues ? continued : 0);
    PrunedModel pruned = Prune(of, model, prune);
    if (continues) ContinueShadowing(last_live, &pruned);
    judge(name + ", thinned", pruned.model, pruned.layout, pruned.E);
    choose(pruned.model, pruned.layout);
  };

  const TableLayout all = TableLayout::Full(fitted.spec());
  judge("as fitted", fitted, all, objective.Value(fitted));
  choose(fitted, all);
  if (best.chosen < 0) thin("as fitted", objective, fitted);
  if (best.chosen < 0) {
    // One parameter a table is still too much: lobes and colours have to go, and no form that
    // shares less has a chance.
    const PrunedModel pruned = Prune(objective, fitted, {.max_parameters = options.max_parameters});
    judge("as fitted, pruned", pruned.model, pruned.layout, pruned.E);
    choose(pruned.model, pruned.layout);
    if (best.chosen < 0) {
      throw Error("no form of the model keeps to " + std::to_string(options.max_parameters) +
                  " parameters; its values overflow");
    }
    return best;
  }
  struct Fitted {
    std::string name;
    Objective objective;
    FactorModel model;
    double score;
  };
  std::vector<Fitted> forms;
  for (const Form& form : Forms(fitted)) {
    if (options.stop()) return best;
    Objective of(objective, form.start.spec());
    FactorModel model = Fit(of, form.start, options.stop);
    const double score = judge(form.name, model, TableLayout::Full(model.spec()), of.Value(model));
    forms.push_back({form.name, std::move(of), std::move(model), score});
  }
  // What follows takes time, and changes little of what a form has gained: only the best ones.
  std::ranges::stable_sort(forms, std::greater(), &Fitted::score);
  for (Fitted& form : forms) {
    if (options.stop() || form.score <= best.candidates[best.chosen].score) break;
    TieEntriesAtDataEdge(form.objective, &form.model);
    const TableLayout layout = TableLayout::Full(form.model.spec());
    if (layout.num_parameters(form.model.spec()) > options.max_parameters) {
      thin(form.name, form.objective, form.model);
    } else {
      Canonicalize(form.objective.coverage(), &form.model);
      judge(form.name + ", finished", form.model, layout, form.objective.Value(form.model));
      choose(form.model, layout);
    }
  }
  return best;
}

}  // namespace trilobe
