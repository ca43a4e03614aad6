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
#include "trilobe/solvers/race/stretch_search.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// A form before thinning: what it is called, where its fit begins, and what that minimises.
struct Form {
  std::string name;
  FactorModel start;
  Weighting weighting;
  bool anew = false;  // from starts of its own, since it ends in another minimum
};

// A stretch that lowers E by less than this fraction is none.
constexpr double kWorthwhile = 0.05;

// Whether much of what a material reflects has a channel near 0, where a picture shows errors that
// are small beside the mean of the channels, by which samples are weighed.
bool IsSaturated(const BrdfSamples& samples) {
  constexpr double kNearBlack = 0.1, kMuch = 0.1;
  double all = 0, saturated = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const Rgb& rho = samples.rho[j];
    const double mean = (rho[0] + rho[1] + rho[2]) / 3;
    const Cosines cosines = samples.CosinesOf(j);
    const double light = samples.SolidAngle(j) * cosines.i * cosines.o * mean;
    all += light;
    if (std::ranges::min(rho) < kNearBlack * mean) saturated += light;
  }
  return saturated > kMuch * all;
}

// The same values with tables shared by less.
FactorModel SharingLess(const FactorModel& model, const ModelSpec& spec) {
  FactorModel result(spec);
  const Reduction repeat = Reduction::BySharing(spec, model.spec());
  std::ranges::copy(repeat.Expand(model.parameters()), result.parameters().begin());
  return result;
}

// Those that share less than a model, or have a lobe more.
std::vector<Form> FormsFrom(const Form& base) {
  const FactorModel& fitted = base.start;
  const ModelSpec& own = fitted.spec();
  const std::string prefix = base.name.empty() ? "" : base.name + ", ";
  std::vector<Form> forms;
  if (own.lobes > 1 && !own.F.per_lobe) {
    ModelSpec spec = own;
    spec.F.per_lobe = true;
    forms.push_back({prefix + "F by lobe", SharingLess(fitted, spec), base.weighting});
  }
  if (own.lobes > 0 && !own.D.per_channel) {
    ModelSpec spec = own;
    spec.D.per_channel = true;
    forms.push_back({prefix + "D by channel", SharingLess(fitted, spec), base.weighting});
  }
  if (own.lobes > 0 && own.lobes < kMaxLobes && own.D.per_lobe) {
    forms.push_back(
        {prefix + "a lobe more", SplitLobe(fitted, StrongestLobe(fitted)), base.weighting});
  }
  return forms;
}

// So many samples that what a model makes of them is nearly what it makes of all.
Objective Thinned(const Objective& objective) {
  constexpr int kSamplesPerParameter = 100, kMaxStride = 24;
  const int wanted = kSamplesPerParameter * objective.spec().num_parameters();
  const int stride = std::clamp(objective.samples().size() / wanted, 1, kMaxStride);
  if (stride == 1) return objective;
  return {Thinned(objective.samples(), stride), objective.spec(), objective.weighting(),
          objective.num_threads()};
}

// Where few samples lead, a few joint steps on all of them go on: an entry that the few hardly read
// may be anything.
FactorModel OnAll(const Objective& objective, const FactorModel& start,
                  const std::function<bool()>& stop, const Reduction* reduction = nullptr) {
  constexpr int kSteps = 2;
  PhaseSeconds phases;
  JointStepper stepper(objective, JointStepper::Curvature::kByProgress,
                       reduction ? JointStepper::Trial::kAsItIs : JointStepper::Trial::kProjected,
                       &phases, reduction);
  stepper.Restart(start);
  for (int k = 0; k < kSteps && !stepper.exhausted() && !stop(); ++k) stepper.Step();
  return stepper.current();
}

// Joint steps on few samples.
FactorModel Fit(const Objective& objective, const FactorModel& start,
                const std::function<bool()>& stop) {
  constexpr StartRace::Thinning kThinned{.samples_per_parameter = 25, .max_stride = 24};
  constexpr int kSteps = 12;
  StartRace race(objective, kThinned, stop);
  race.Enter("", [&start] { return std::optional(start); }, {.count = 0});
  race.Advance(kSteps);
  return race.leader() != nullptr ? *race.leader() : start;
}

// What the default solver makes of few samples from its own starts.
FactorModel FitAnew(const Objective& objective, const FactorModel& start,
                    const std::function<bool()>& stop) {
  FactorModel model = start;
  SolverOptions options;
  options.diagnose = false;
  options.on_iteration = [&stop](const IterationRecord&, const FactorModel&) { return !stop(); };
  MakeSolver("auto")->Solve(Thinned(objective), options, &model);
  return model;
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
  // What is not wild has at least this beyond the data.
  double beyond = -std::numeric_limits<double>::infinity();
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
    ModelCandidate& last = best.candidates.back();
    if (last.num_parameters > options.max_parameters) return;
    if (best.chosen >= 0 && !(last.score > best.candidates[best.chosen].score)) return;
    if (options.judge_beyond && best.chosen >= 0) {
      last.wild = !(options.judge_beyond(model) >= beyond);
      if (last.wild) return;
    }
    best.chosen = static_cast<int>(best.candidates.size()) - 1;
    best.model = model;
    best.layout = layout;
  };
  // Of all samples; what it takes to prepare them is made once for a stretch and a weighting.
  std::vector<Objective> prepared = {objective};
  const auto on_all = [&](const ModelSpec& spec, const Weighting& weighting) -> Objective {
    const auto alike = std::ranges::find_if(prepared, [&](const Objective& other) {
      return other.spec().stretch == spec.stretch && other.weighting().name == weighting.name;
    });
    if (alike != prepared.end()) return {*alike, spec};
    prepared.push_back(
        weighting.name == objective.weighting().name
            ? Objective(objective, spec)
            : Objective(objective.samples(), spec, weighting, objective.num_threads()));
    return prepared.back();
  };
  // E, as it is quoted, is of the objective that was asked for.
  const auto value_of = [&](const FactorModel& model) {
    return on_all(model.spec(), objective.weighting()).Value(model);
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
    PrunedModel pruned = Prune(Thinned(of), model, prune);
    const Objective to(of, pruned.model.spec());
    const Reduction stored(to.spec(), pruned.layout);
    pruned.model = OnAll(to, pruned.model, options.stop, &stored);
    if (continues) ContinueShadowing(last_live, &pruned);
    judge(name + ", thinned", pruned.model, pruned.layout, value_of(pruned.model));
    choose(pruned.model, pruned.layout);
  };

  const TableLayout all = TableLayout::Full(fitted.spec());
  judge("as fitted", fitted, all, objective.Value(fitted));
  constexpr double kMayLose = 1;  // [dB]
  if (options.judge_beyond) beyond = options.judge_beyond(fitted) - kMayLose;
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
    Objective objective;  // that it was fitted to
    FactorModel model;
    double score;
  };
  std::vector<Fitted> forms;
  const auto fit = [&](const Form& form) {
    if (options.stop()) return;
    const ModelSpec& spec = form.start.spec();
    Objective of = on_all(spec, form.weighting);
    const FactorModel start =
        form.anew ? FitAnew(of, form.start, options.stop) : Fit(of, form.start, options.stop);
    FactorModel model = OnAll(of, start, options.stop);
    const double score = judge(form.name, model, TableLayout::Full(spec), value_of(model));
    forms.push_back({form.name, std::move(of), std::move(model), score});
  };
  // The form that the others go on from: that of the first two which looks best.
  Form base{"", fitted, objective.weighting()};
  double base_score = best.candidates[best.chosen].score;
  const auto go_on_from = [&](Form form) {
    base_score = forms.back().score;
    form.start = forms.back().model;
    form.anew = false;
    base = std::move(form);
  };
  Form next = base;
  if (fitted.spec().lobes > 0 && !fitted.spec().anisotropic() && !fitted.spec().stretch.any()) {
    next = {"stretched", FitStretch(objective, fitted, options.stop), base.weighting};
    fit(next);
    if (options.stop()) return best;
    // Under other weights it may look better even where it does not under these.
    if (!(best.candidates.back().E < (1 - kWorthwhile) * best.candidates.front().E)) {
      next = base;
    } else if (forms.back().score > base_score) {
      go_on_from(next);
    }
  }
  if (next.weighting.name == "appearance" && IsSaturated(objective.samples())) {
    next.name += next.name.empty() ? "weighed by channel" : ", weighed by channel";
    next.weighting = FindWeighting("appearance_channel");
    next.anew = true;
    fit(next);
    if (options.stop()) return best;
    if (forms.back().score > base_score) go_on_from(next);
  }
  for (const Form& form : FormsFrom(base)) fit(form);
  if (options.stop()) return best;
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
      judge(form.name + ", finished", form.model, layout, value_of(form.model));
      choose(form.model, layout);
    }
  }
  return best;
}

}  // namespace trilobe
