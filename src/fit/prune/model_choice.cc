#include "fit/prune/model_choice.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "fit/finish/data_edge.h"
#include "fit/finish/reflectance.h"
#include "fit/finish/search.h"
#include "fit/finish/stretch_search.h"
#include "fit/finish/without_rings.h"
#include "fit/prune/model_forms.h"
#include "fit/prune/prune.h"
#include "fit/prune/thinned_objective.h"
#include "fit/prune/unmeasured_prior.h"
#include "model/objective/canonical_form.h"
#include "model/objective/gauge.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/reduction.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/objective/score.h"

namespace trilobe {
namespace {

// Loss of PSNR that nobody sees in a picture [dB].
constexpr double kNotSeen = 0.2;

// Least relative decrease of E for which a stretch is kept.
constexpr double kWorthwhile = 0.05;

// Fewest parameters that thinning can leave: a node per table, besides d, s and exponents.
int LeastStored(const ModelSpec& spec) {
  TableLayout layout = TableLayout::Full(spec);
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) layout.of(factor, t).resize(1);
  }
  return layout.num_parameters(spec);
}

Objective Thinned(const Objective& objective, const SampleThinning& thinning) {
  return ThinnedObjective(objective, objective.spec().num_parameters(), thinning);
}

// Continues a fit to few samples by joint steps on more: an entry that the few hardly read may be
// anything.
FactorModel ContinueFit(const Objective& objective, const FactorModel& start, const StopCheck& stop,
                        const Reduction* reduction = nullptr) {
  constexpr int kSteps = 2;
  return JointSteps(objective, start, kSteps, stop, reduction).model;
}

// Objectives of the same samples for other specs and weightings; what it takes to prepare the
// samples is made once for a weighting and stretches.
class Objectives {
 public:
  explicit Objectives(const Objective& own) : made_({own}) {}

  const Objective& own() const { return made_.front(); }

  Objective ObjectiveFor(const ModelSpec& spec, const Weighting& weighting) {
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

// The search of ChooseModel. Forms are fitted to some samples; only those that are stored as a
// whole, to all.
class ModelSearch {
 public:
  ModelSearch(const Objective& objective, const FactorModel& fitted,
              const ModelChoiceOptions& options)
      : objective_(objective),
        fitted_(fitted),
        options_(options),
        search_(options.judge, {.max_parameters = options.max_parameters}),
        all_(objective),
        some_(Thinned(objective, kSomeSamples)),
        few_(Thinned(objective, kFewSamples)),
        prior_(objective, fitted),
        some_with_prior_(prior_.JoinTo(some_.own())),
        few_with_prior_(prior_.JoinTo(few_.own())) {}

  ChosenModel Run() {
    const TableLayout full = TableLayout::Full(fitted_.spec());
    Try("as fitted", fitted_, full, objective_.Value(fitted_));
    some_of_fit_ = some_.own().Value(fitted_);
    if (options_.judge_beyond) beyond_ = options_.judge_beyond(fitted_);
    Choose(fitted_, full, objective_.weighting());
    if (!search_.has_leader()) Thin("as fitted", objective_.weighting(), fitted_);
    if (!search_.has_leader()) {
      PruneTheFit();
    } else if (FitBases() && FitForms()) {
      FinishBestForms();
    }
    best_.candidates = search_.candidates();
    best_.chosen = search_.chosen();
    return std::move(best_);
  }

 private:
  struct Fitted {
    ModelForm form;  // with the fitted model as its start
    double score;
  };

  void Try(const std::string& name, const FactorModel& model, const TableLayout& layout, double E) {
    search_.Try(name, model, layout.num_parameters(model.spec()), E);
  }

  // The last candidate, if it is the best that keeps to the budget. `is_even`: it is known to have
  // no rings.
  void Choose(const FactorModel& model, const TableLayout& layout, const Weighting& weighting,
              bool is_even = false) {
    if (!search_.LastLeads()) return;
    Candidate& last = search_.last();
    if (search_.has_leader() && !is_even) {
      last.has_rings = HasRings(model, objective_.num_threads());
    }
    if (last.has_rings) return;
    if (options_.judge_beyond && search_.has_leader()) {
      constexpr double kMayLose = 3, kOfGain = 0.5;  // [dB]
      const double gain = last.score - search_.first().score;
      last.fails_beyond =
          !(beyond_ - options_.judge_beyond(model) <= std::max(kMayLose, kOfGain * gain));
      if (last.fails_beyond) return;
    }
    search_.TakeLast();
    best_.model = model;
    best_.layout = layout;
    best_.weighting = weighting;
  }

  // E, as it is quoted, is of the objective that was asked for; of a form on its way, as these
  // samples tell it.
  double ValueOfSome(const FactorModel& model) {
    const double E = some_.ObjectiveFor(model.spec(), objective_.weighting()).Value(model);
    return some_of_fit_ > 0 ? E * (search_.first().E / some_of_fit_) : E;
  }

  // All samples would have to be prepared for a stretch, which takes longer than to evaluate them
  // once.
  double ValueOf(const FactorModel& model) {
    if (!model.spec().stretches.any()) {
      return all_.ObjectiveFor(model.spec(), objective_.weighting()).Value(model);
    }
    const std::vector<Rgb> values =
        UnclampedSamples(model, objective_.samples(), objective_.num_threads());
    return ScoreValues(objective_, values).objective;
  }

  // Beyond the data it goes on about as the whole model does.
  void Thin(const std::string& name, const Weighting& weighting, const FactorModel& model) {
    const UnmeasuredPrior prior(objective_, model);
    PruneOptions prune;
    prune.lobes = prune.colour = false;
    prune.max_parameters = options_.max_parameters;
    // The fit itself has to come down to the budget. Of forms it takes long to see whether G had
    // better be shared, and hardly ever it had.
    const bool of_fit = !search_.has_leader();
    prune.sharing = of_fit;
    if (!of_fit) prune.stop = options_.stop;
    PrunedModel pruned =
        Prune(prior.JoinTo(few_.ObjectiveFor(model.spec(), weighting)), model, prune);
    if (!of_fit && options_.stop()) return;
    const Objective refitted = prior.JoinTo(some_.ObjectiveFor(pruned.model.spec(), weighting));
    const Reduction stored(refitted.spec(), pruned.layout);
    pruned.model = ContinueFit(refitted, pruned.model, options_.stop, &stored);
    const bool is_even = !of_fit && !HasRings(pruned.model, objective_.num_threads());
    // Nodes that were chosen by E, with the values of the form.
    if (!of_fit && !is_even) pruned.model = model;
    // Scale by what was measured, without the prior.
    const Objective measured = some_.ObjectiveFor(pruned.model.spec(), weighting);
    SetCanonicalScale(measured.coverage(), &pruned.model, measured.num_threads());
    ExpandStored(pruned.layout, &pruned.model);
    Try(name + ", thinned", pruned.model, pruned.layout, ValueOf(pruned.model));
    Choose(pruned.model, pruned.layout, weighting, is_even);
  }

  // For where one parameter a table is still too much: lobes and colours have to go, and no form
  // that shares less has a chance.
  void PruneTheFit() {
    const PrunedModel pruned =
        Prune(objective_, fitted_, {.max_parameters = options_.max_parameters});
    Try("as fitted, pruned", pruned.model, pruned.layout, pruned.E);
    Choose(pruned.model, pruned.layout, objective_.weighting());
    if (search_.has_leader()) return;
    throw Error(ErrorKind::kRange, "no form of the model keeps to " +
                                       std::to_string(options_.max_parameters) +
                                       " parameters; its values overflow")
        .About("max_parameters", options_.max_parameters);
  }

  // This and what calls it: false once it is to stop; then what was to be fitted is not among
  // forms_.
  bool Fit(ModelForm form) {
    if (options_.stop()) return false;
    const ModelSpec& spec = form.start.spec();
    constexpr int kStepsOnFew = 12;
    constexpr double kSmall = 2e-3;  // a decrease of E, relative, that no picture shows
    form.start = JointSteps(few_with_prior_.ObjectiveFor(spec, form.weighting), form.start,
                            kStepsOnFew, options_.stop, /*reduction=*/nullptr, kSmall)
                     .model;
    form.start =
        ContinueFit(some_with_prior_.ObjectiveFor(spec, form.weighting), form.start, options_.stop);
    // Entries that no measured sample reads are what the prior makes of them, next to others that
    // have moved far away; a picture reads between the two.
    Canonicalize(some_.ObjectiveFor(spec, form.weighting), &form.start);
    Try(form.name, form.start, TableLayout::Full(spec), ValueOfSome(form.start));
    forms_.push_back({std::move(form), search_.last().score});
    return true;
  }

  // Fits the bases of the forms: the fit itself, stretched, and weighed by channel.
  bool FitBases() {
    bases_ = {{{"", fitted_, objective_.weighting()}, search_.first().score}};
    return FitStretchedBase() && FitBasesByChannel();
  }

  // The second base, where highlights stretch. Under other weights it may look better even where it
  // does not under these.
  bool FitStretchedBase() {
    const ModelSpec& spec = fitted_.spec();
    if (spec.lobes == 0 || spec.anisotropic() || spec.stretches.any()) return true;
    const Objective few = few_with_prior_.ObjectiveFor(spec, objective_.weighting());
    SteppedModel stretch = FitStretches(few, fitted_, options_.stop);
    if (!Fit({"stretched", stretch.model, objective_.weighting()})) return false;
    double E = search_.last().E;
    Fitted best = forms_.back();
    const Objective* judged = &few;
    // The prior is what the fit says where nothing was measured, and would lead the second way back
    // to it. So it goes without, and the picture tells which of both is better.
    const Objective measured = few_.ObjectiveFor(spec, objective_.weighting());
    std::optional<SteppedModel> anew =
        FitStretchesAnew(measured, fitted_, stretch.model, options_.stop);
    if (anew) {
      if (!Fit({"stretched anew", anew->model, objective_.weighting()})) return false;
      if (forms_.back().score > best.score) {
        E = search_.last().E;
        best = forms_.back();
        stretch = *std::move(anew);
        judged = &measured;
      }
    }
    const bool stretched =
        stretch.model.spec().stretches.any() && E < (1 - kWorthwhile) * search_.first().E &&
        !SharesLess(*judged, few_.own().samples().size(), fitted_, stretch, options_.stop);
    if (stretched) bases_.push_back(std::move(best));
    return true;
  }

  // Fits bases weighed by channel if weights by the mean of the channels hide what pictures show.
  bool FitBasesByChannel() {
    if (objective_.weighting().name != "appearance" || !IsSaturated(objective_.samples())) {
      return true;
    }
    const bool stretched = bases_.size() > 1;
    // Selections keep the level of the whole.
    const Weighting by_channel =
        ForSamples(FindWeighting("appearance_channel"), objective_.samples());
    if (stretched) {
      const ModelForm form{"stretched, weighed by channel", bases_.back().form.start, by_channel};
      if (!Fit(form)) return false;
      bases_.push_back(forms_.back());
    }
    // Starts of its own, since it ends in another minimum.
    ModelForm form{"weighed by channel anew",
                   FitBySolver("auto", few_with_prior_.ObjectiveFor(fitted_.spec(), by_channel),
                               fitted_, options_.stop),
                   by_channel};
    if (stretched) {
      const Objective few = few_with_prior_.ObjectiveFor(fitted_.spec(), by_channel);
      form = {"stretched, weighed by channel anew",
              FitStretches(few, form.start, options_.stop).model, by_channel};
    }
    if (!Fit(form)) return false;
    bases_.push_back(forms_.back());
    return true;
  }

  // From the best base fits the form that shares neither F nor D; then the better of both with one
  // more lobe. The more nodes there are to choose from, the better those that thinning leaves.
  bool FitForms() {
    Fitted best = std::ranges::max(bases_, {}, &Fitted::score);
    if (const std::optional<ModelForm> form = FormSharingNeither(best.form)) {
      if (!Fit(*form)) return false;
      if (forms_.back().score > best.score) best = forms_.back();
    }
    const std::optional<ModelForm> form = FormWithALobeMore(best.form);
    return !form || Fit(*form);
  }

  // Takes time, and changes little of what a form has gained: only the best ones.
  void FinishBestForms() {
    std::ranges::stable_sort(forms_, std::greater(), &Fitted::score);
    for (Fitted& fitted_form : forms_) {
      if (options_.stop()) break;
      if (fitted_form.score <= search_.leader().score + kNotSeen) break;
      auto& [name, model, weighting] = fitted_form.form;
      if (LeastStored(model.spec()) > options_.max_parameters) continue;
      const TableLayout layout = TableLayout::Full(model.spec());
      if (layout.num_parameters(model.spec()) > options_.max_parameters) {
        model = TieUnlessSeen(some_.ObjectiveFor(model.spec(), weighting), model, fitted_form.score,
                              TieRefit::kUntilBack);
        model = EvenOut(some_.ObjectiveFor(model.spec(), weighting),
                        some_with_prior_.ObjectiveFor(model.spec(), weighting), model);
        Thin(name, weighting, model);
      } else {
        const Objective all = all_.ObjectiveFor(model.spec(), weighting);
        model = ContinueFit(all, model, options_.stop);
        Canonicalize(all, &model);
        model = TieUnlessSeen(all, model, search_.judge()(model), TieRefit::kUntilSettled);
        model = EvenOut(all, all, model);
        Try(name + ", finished", model, layout, ValueOf(model));
        Choose(model, layout, weighting);
      }
    }
  }

  // The model, without rings if the picture hardly suffers. Its light is matched before, as that
  // would bring new rings.
  FactorModel EvenOut(const Objective& measured, const Objective& minimised,
                      const FactorModel& model) const {
    constexpr double kPriceOfLight = 10;
    if (!HasRings(model, objective_.num_threads())) return model;
    const double score = search_.judge()(model);
    const auto is_harmless = [&](const FactorModel& even) {
      return search_.judge()(even) >= score - kMayLoseForRings;
    };
    const std::optional<MatchedModel> matched = MatchReflectance(
        measured, minimised, model, TableLayout::Full(model.spec()), kPriceOfLight, options_.stop);
    return WithoutRings(minimised, matched ? matched->model : model, is_harmless, options_.stop)
        .value_or(model);
  }

  // The model, in canonical form and of this score, with entries at the edge of the data tied,
  // unless that is seen where data are.
  FactorModel TieUnlessSeen(const Objective& objective, const FactorModel& model, double score,
                            TieRefit refit) {
    FactorModel tied = model;
    if (!TieEntriesAtDataEdge(objective, &tied, options_.stop, refit)) return model;
    Canonicalize(objective, &tied);
    return search_.judge()(tied) >= score - kNotSeen ? tied : model;
  }

  const Objective& objective_;
  const FactorModel& fitted_;
  const ModelChoiceOptions& options_;
  Search search_;
  Objectives all_, some_, few_;
  const UnmeasuredPrior prior_;  // for forms that go on from the fit
  Objectives some_with_prior_, few_with_prior_;
  double beyond_ = 0;       // the data, the score of the fit
  double some_of_fit_ = 0;  // of E of the fit
  std::vector<Fitted> bases_, forms_;
  ChosenModel best_;
};

}  // namespace

ChosenModel ChooseModel(const Objective& objective, const FactorModel& fitted,
                        const ModelChoiceOptions& options) {
  return ModelSearch(objective, fitted, options).Run();
}

}  // namespace trilobe
