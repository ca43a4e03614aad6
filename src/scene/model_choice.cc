#include "trilobe/scene/model_choice.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/base/stopwatch.h"
#include "trilobe/math/catmull_rom.h"
#include "trilobe/model/gauge.h"
#include "trilobe/model/lobes.h"
#include "trilobe/model/reconstruct.h"
#include "trilobe/objective/score.h"
#include "trilobe/scene/prune.h"
#include "trilobe/solvers/joint/data_edge.h"
#include "trilobe/solvers/joint/joint_step.h"
#include "trilobe/solvers/joint/reduction.h"
#include "trilobe/solvers/joint/stretch_search.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// A form before thinning: what it is called, where its fit begins, and what that minimises.
struct Form {
  std::string name;
  FactorModel start;
  Weighting weighting;
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

// So many samples for each parameter, more at angles that few have: an entry that is read by none
// of those left could be anything, and for all samples the model would be far off.
Objective Thinned(const Objective& objective, int samples_per_parameter, int max_stride) {
  constexpr int kLeast = 16;  // samples a place, as many times as there are for each parameter
  const int wanted = samples_per_parameter * objective.spec().num_parameters();
  const int stride = std::clamp(objective.samples().size() / wanted, 1, max_stride);
  if (stride == 1) return objective;
  return {ThinnedByPlace(objective.samples(), stride, kLeast * samples_per_parameter),
          objective.spec(), objective.weighting(), objective.num_threads()};
}

// So many that what a model makes of them is nearly what it makes of all.
Objective Some(const Objective& objective) { return Thinned(objective, 100, 24); }

// So few that a joint step takes hardly longer than its algebra: they tell which form E wants.
Objective Few(const Objective& objective) { return Thinned(objective, 32, 72); }

// Where few samples lead, a few joint steps on more of them go on: an entry that the few hardly
// read may be anything.
FactorModel GoOn(const Objective& objective, const FactorModel& start,
                 const std::function<bool()>& stop, const Reduction* reduction = nullptr) {
  constexpr int kSteps = 2;
  return JointSteps(objective, start, kSteps, stop, reduction).model;
}

// Objectives of the same samples for other specs and weightings; what it takes to prepare the
// samples is made once for a weighting and stretches.
class Objectives {
 public:
  explicit Objectives(const Objective& own) : made_({own}) {}

  Objective For(const ModelSpec& spec, const Weighting& weighting) {
    const auto alike = std::ranges::find_if(made_, [&](const Objective& other) {
      return other.weighting().name == weighting.name &&
             other.spec().stretches.distinct() == spec.stretches.distinct();
    });
    if (alike != made_.end()) return {*alike, spec};
    const Objective& own = made_.front();
    made_.push_back(weighting.name == own.weighting().name
                        ? Objective(own, spec)
                        : Objective(own.samples(), spec, weighting, own.num_threads()));
    return made_.back();
  }

 private:
  std::vector<Objective> made_;
};

// What the default solver makes of few samples from its own starts.
FactorModel FitAnew(const Objective& some, const FactorModel& start,
                    const std::function<bool()>& stop) {
  FactorModel model = start;
  SolverOptions options;
  options.diagnose = false;
  options.on_iteration = [&stop](const IterationRecord&, const FactorModel&) { return !stop(); };
  MakeSolver("auto")->Solve(some, options, &model);
  return model;
}

// Whether the data rather have a form that shares less: a stretch may look like one. What more
// parameters fit of few samples by chance is taken off.
bool SharesLess(const Objective& few, const FactorModel& fitted, const SteppedModel& stretched,
                const std::function<bool()>& stop) {
  constexpr int kSteps = 5;
  const double values = kChannels * few.samples().size() / 2.0;  // exchanged ones say the same
  const auto expected = [&](double E, const ModelSpec& spec) {
    const double share = std::min(spec.num_parameters() / values, 0.9);
    return E * (1 + share) / (1 - share);
  };
  return std::ranges::any_of(FormsFrom({"", fitted, few.weighting()}), [&](const Form& form) {
    const ModelSpec& spec = form.start.spec();
    if (spec.lobes != fitted.spec().lobes) return false;
    const double E = JointSteps(Objective(few, spec), form.start, kSteps, stop).E;
    return expected(E, spec) < expected(stretched.E, stretched.model.spec());
  });
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
  double beyond = 0;  // the data, the score of the fit
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
      constexpr double kMayLose = 1, kOfGain = 0.5;  // [dB]
      const double gain = last.score - best.candidates.front().score;
      last.wild = !(beyond - options.judge_beyond(model) <= std::max(kMayLose, kOfGain * gain));
      if (last.wild) return;
    }
    best.chosen = static_cast<int>(best.candidates.size()) - 1;
    best.model = model;
    best.layout = layout;
  };
  // Forms are fitted to some samples; only what is thinned of them, to all.
  Objectives all(objective), some(Some(objective)), few(Few(objective));
  // E, as it is quoted, is of the objective that was asked for. All samples would have to be
  // prepared for a stretch, which takes longer than to evaluate them once.
  const auto value_of = [&](const FactorModel& model) {
    if (!model.spec().stretches.any()) {
      return all.For(model.spec(), objective.weighting()).Value(model);
    }
    const std::vector<Rgb> values =
        EvaluateSamples(model, objective.samples(), objective.num_threads());
    return ScoreValues(objective, values).objective;
  };
  const auto thin = [&](const std::string& name, const Weighting& weighting,
                        const FactorModel& model) {
    const Objective of = all.For(model.spec(), weighting);
    const std::vector<int> last_live = LastLiveNodes(of);
    const auto continued = 2 * static_cast<int>(std::ranges::count_if(last_live, [&](int k) {
                             return k < of.spec().g_axis.size - 1;
                           }));
    PruneOptions prune;
    prune.lobes = prune.colour = false;
    // Not where next to nothing would be left.
    const bool continues = continued > 0 && options.max_parameters > 4 * continued;
    prune.max_parameters = options.max_parameters - (continues ? continued : 0);
    PrunedModel pruned = Prune(few.For(model.spec(), weighting), model, prune);
    const Objective to(of, pruned.model.spec());
    const Reduction stored(to.spec(), pruned.layout);
    pruned.model = GoOn(to, pruned.model, options.stop, &stored);
    if (continues) ContinueShadowing(last_live, &pruned);
    judge(name + ", thinned", pruned.model, pruned.layout, value_of(pruned.model));
    choose(pruned.model, pruned.layout);
  };

  const TableLayout full = TableLayout::Full(fitted.spec());
  judge("as fitted", fitted, full, objective.Value(fitted));
  if (options.judge_beyond) beyond = options.judge_beyond(fitted);
  choose(fitted, full);
  if (best.chosen < 0) thin("as fitted", objective.weighting(), fitted);
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
    Form form;  // with the fitted model as its start
    double score;
  };
  std::vector<Fitted> forms;
  // False once it is to stop; then there is no such form.
  const auto fit = [&](Form form) {
    if (options.stop()) return false;
    const ModelSpec& spec = form.start.spec();
    constexpr int kStepsOnFew = 12;
    const Objective of_few = few.For(spec, form.weighting);
    form.start = JointSteps(of_few, form.start, kStepsOnFew, options.stop).model;
    form.start = GoOn(some.For(spec, form.weighting), form.start, options.stop);
    const double E = value_of(form.start);
    const double score = judge(form.name, form.start, TableLayout::Full(spec), E);
    forms.push_back({std::move(form), score});
    return true;
  };
  // The forms that the others go on from: that of the first which looks best, and any that looks
  // nearly as good.
  std::vector<Fitted> bases = {
      {{"", fitted, objective.weighting()}, best.candidates[best.chosen].score}};
  bool stretched = false;
  if (fitted.spec().lobes > 0 && !fitted.spec().anisotropic() && !fitted.spec().stretches.any()) {
    const Objective of = few.For(fitted.spec(), objective.weighting());
    const SteppedModel start = FitStretches(of, fitted, options.stop);
    if (!fit({"stretched", start.model, objective.weighting()})) return best;
    // Under other weights it may look better even where it does not under these.
    stretched = start.model.spec().stretches.any() &&
                best.candidates.back().E < (1 - kWorthwhile) * best.candidates.front().E &&
                !SharesLess(of, fitted, start, options.stop);
    if (stretched) bases.push_back(forms.back());
  }
  if (objective.weighting().name == "appearance" && IsSaturated(objective.samples())) {
    // Selections keep the level of the whole.
    const Weighting by_channel =
        ForSamples(FindWeighting("appearance_channel"), objective.samples());
    if (stretched) {
      const Form form{"stretched, weighed by channel", forms.back().form.start, by_channel};
      if (!fit(form)) return best;
      bases.push_back(forms.back());
    }
    // From starts of its own, since it ends in another minimum.
    Form form{"weighed by channel anew",
              FitAnew(some.For(fitted.spec(), by_channel), fitted, options.stop), by_channel};
    if (stretched) {
      const Objective of = few.For(fitted.spec(), by_channel);
      form = {"stretched, weighed by channel anew",
              FitStretches(of, form.start, options.stop).model, by_channel};
    }
    if (!fit(form)) return best;
    bases.push_back(forms.back());
  }
  constexpr double kNearly = 1;  // [dB]
  const double best_base = std::ranges::max(bases, {}, &Fitted::score).score;
  for (const Fitted& base : bases) {
    if (base.score < best_base - kNearly) continue;
    for (const Form& form : FormsFrom(base.form)) {
      if (!fit(form)) return best;
    }
  }
  if (options.stop()) return best;
  // What follows takes time, and changes little of what a form has gained: only the best ones.
  std::ranges::stable_sort(forms, std::greater(), &Fitted::score);
  for (Fitted& fitted_form : forms) {
    if (options.stop() || fitted_form.score <= best.candidates[best.chosen].score) break;
    auto& [name, model, weighting] = fitted_form.form;
    const TableLayout layout = TableLayout::Full(model.spec());
    if (layout.num_parameters(model.spec()) > options.max_parameters) {
      TieEntriesAtDataEdge(some.For(model.spec(), weighting), &model, options.stop);
      thin(name, weighting, model);
    } else {
      const Objective of = all.For(model.spec(), weighting);
      model = GoOn(of, model, options.stop);
      TieEntriesAtDataEdge(of, &model, options.stop);
      Canonicalize(of.coverage(), &model);
      judge(name + ", finished", model, layout, value_of(model));
      choose(model, layout);
    }
  }
  return best;
}

}  // namespace trilobe
