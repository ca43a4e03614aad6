#include "fit/prune/prune_anisotropic.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fit/prune/lobe_search.h"
#include "fit/prune/prune.h"
#include "fit/prune/pruning.h"
#include "model/objective/lobes.h"
#include "solvers/joint/reduction.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe {
namespace {

constexpr int kFewestPhi = 4, kFewestTheta = 3;

// The model with each ring of one theta at its mean.
FactorModel Rounded(FactorModel model) {
  const ModelSpec spec = model.spec();
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    const int columns = spec.axis(factor).phi_nodes;
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::span<double> table = model.table(factor, t);
      for (size_t begin = 0; begin < table.size(); begin += columns) {
        const std::span<double> ring = table.subspan(begin, columns);
        double mean = 0;
        for (const double x : ring) mean += x / columns;
        std::ranges::fill(ring, mean);
      }
    }
  }
  return model;
}

// A model with less of something, to start from; nothing where there is none.
struct Reduced {
  std::string what;
  std::vector<FactorModel> starts;
};

std::string NodesText(const Axis& axis) {
  return std::to_string(axis.theta.size()) + " x " + std::to_string(axis.phi_nodes) + " nodes";
}

// The model with D or G on another axis.
Reduced OnAxis(const FactorModel& model, Factor factor, Axis axis) {
  ModelSpec spec = model.spec();
  const std::string what = std::string(FactorName(factor)) + " on " + NodesText(axis) +
                           " instead of " + NodesText(spec.axis(factor));
  (factor == Factor::kD ? spec.d_axis : spec.g_axis) = std::move(axis);
  return {what, {WithAxes(model, spec)}};
}

// The model with this share of the phi of D or G: an even number, as most materials look the same
// turned by 180 degrees.
std::optional<Reduced> WithFewerPhi(const FactorModel& model, Factor factor, double share) {
  const Axis& axis = model.spec().axis(factor);
  const int fewer = std::max(2 * static_cast<int>(share * axis.phi_nodes / 2), kFewestPhi);
  if (fewer >= axis.phi_nodes) return std::nullopt;
  return OnAxis(model, factor, Axis::Polar(axis.theta, fewer));
}

// The model without every sixth theta of D or G, ends apart, and those towards the horizon.
std::optional<Reduced> WithFewerTheta(const FactorModel& model, Factor factor) {
  const Axis& all = model.spec().axis(factor);
  const Axis axis = all.WithoutHorizon();
  const int rings = static_cast<int>(axis.theta.size());
  const int fewer = std::max(5 * rings / 6, kFewestTheta);
  if (fewer >= rings) return std::nullopt;
  std::vector<double> theta;
  for (int a = 0; a < fewer; ++a) {
    theta.push_back(axis.theta[(a * (rings - 1) + (fewer - 1) / 2) / (fewer - 1)]);
  }
  const Axis thinned = Axis::Polar(std::move(theta), axis.phi_nodes);
  return OnAxis(model, factor, all.reaches_horizon() ? thinned.ToHorizon() : thinned);
}

Reduced Sharing(const FactorModel& model, const ModelSpec& fewer, const std::string& what) {
  FactorModel shared(fewer);
  std::ranges::copy(Reduction::BySharing(model.spec(), fewer).Restrict(model.parameters()),
                    shared.parameters().begin());
  return {what, {std::move(shared)}};
}

std::optional<Reduced> WithOneF(const FactorModel& model) {
  ModelSpec spec = model.spec();
  if (!spec.F.per_channel || spec.lobes == 0) return std::nullopt;
  spec.F.per_channel = false;
  return Sharing(model, spec, "F shared by the channels");
}

std::optional<Reduced> WithOneG(const FactorModel& model) {
  ModelSpec spec = model.spec();
  if (!spec.G.per_lobe || spec.lobes < 2) return std::nullopt;
  spec.G.per_lobe = false;
  return Sharing(model, spec, "G shared by the lobes");
}

std::optional<Reduced> WithFewerLobes(const FactorModel& model) {
  const int lobes = model.spec().lobes;
  if (lobes < 2) return std::nullopt;
  return Reduced{LobesText(lobes - 1) + " instead of " + LobesText(lobes), WithOneLobeLess(model)};
}

using Reduce = std::function<std::optional<Reduced>(const FactorModel&)>;

// In the order in which they are tried: what leaves most out first.
std::vector<Reduce> Reductions(const PruneOptions& options) {
  std::vector<Reduce> reductions;
  if (options.lobes) reductions.emplace_back(WithFewerLobes);
  const auto add_nodes = [&](Factor factor) {
    for (const double share : {0.5, 0.75}) {  // half of them are nodes of before
      reductions.emplace_back(
          [=](const FactorModel& model) { return WithFewerPhi(model, factor, share); });
    }
    reductions.emplace_back(
        [=](const FactorModel& model) { return WithFewerTheta(model, factor); });
  };
  if (options.tables) add_nodes(Factor::kD);
  if (options.shadowing) {
    reductions.emplace_back(WithOneG);
    add_nodes(Factor::kG);
  }
  if (options.colour) reductions.emplace_back(WithOneF);
  return reductions;
}

class AnisotropicPruning {
 public:
  AnisotropicPruning(const Objective& measured, const Objective& with_prior,
                     const FactorModel& full, const PruneOptions& options)
      : with_prior_(with_prior),
        options_(options),
        pruning_(measured, measured, full, options),
        E_with_prior_(with_prior.Value(pruning_.state().model)) {}

  Pruning& pruning() { return pruning_; }
  const PruneState& state() const { return pruning_.state(); }
  bool stopped() const { return options_.stop(); }

  PruneState Fit(const Reduced& candidate) const {
    const ModelSpec& spec = candidate.starts.front().spec();
    const FittedModel fitted =
        FitFrom(candidate.starts, Objective(with_prior_, spec), {.E = Wanted()}, options_.stop);
    return pruning_.MakeState(spec, fitted.model);
  }

  bool Decide(const std::string& what, PruneState next) {
    const bool within = pruning_.KeepsToBudget(next);
    const std::string why = pruning_.CompareWithFull(next.E, within);
    return pruning_.Decide(what, std::move(next), within && !stopped(), why);
  }

  // Applies each reduction as long as the budget is kept.
  void ReduceWhatThereIs() {
    for (const Reduce& reduce : Reductions(options_)) {
      while (!stopped()) {
        const std::optional<Reduced> candidate = reduce(state().model);
        if (!candidate || !Decide(candidate->what, Fit(*candidate))) break;
      }
    }
  }

  // Reduces to this many parameters, each time by what raises E least per parameter saved.
  void ReduceTo(int max_parameters) {
    while (!stopped() && state().num_parameters() > max_parameters) {
      std::optional<std::pair<std::string, PruneState>> best;
      double lowest = kInfinity;
      for (const Reduce& reduce : Reductions(options_)) {
        const std::optional<Reduced> candidate = reduce(state().model);
        if (!candidate) continue;
        PruneState next = Fit(*candidate);
        const int saved = state().num_parameters() - next.num_parameters();
        const double cost = (next.E - state().E) / std::max(saved, 1);
        if (stopped() || !(cost < lowest)) continue;
        lowest = cost;
        best.emplace(candidate->what, std::move(next));
      }
      if (!best) break;
      const std::string why = pruning_.CompareWithFull(best->second.E, true);
      pruning_.Decide(best->first, std::move(best->second), true, why);
    }
    if (state().num_parameters() <= max_parameters) {
      const ModelSpec& spec = state().spec();
      const FittedModel fitted =
          FitFrom({state().model}, Objective(with_prior_, spec), {.E = kInfinity}, options_.stop);
      PruneState next = pruning_.MakeState(spec, fitted.model);
      const bool lower = next.E < state().E;
      pruning_.Decide("fitted again", std::move(next), lower && !stopped(), "");
      return;
    }
    pruning_.Record("all else", state(), false, "what may be left out does not reach the budget");
  }

 private:
  // Target of E with the prior at which E of the measured samples reaches its own.
  double Wanted() const {
    if (pruning_.by_parameters()) return 0;  // nothing can be given up: a few steps tell enough
    if (pruning_.IsExact(pruning_.E_base())) return pruning_.search_limit();
    return pruning_.E_base() > 0 ? E_with_prior_ * pruning_.search_limit() / pruning_.E_base() : 0;
  }

  const Objective& with_prior_;
  const PruneOptions& options_;
  Pruning pruning_;
  const double E_with_prior_;
};

// An isotropic fit of the same samples.
Reduced Isotropic(const FactorModel& model, const Objective& with_prior) {
  const ModelSpec& before = model.spec();
  ModelSpec spec = ModelSpec::SharedFactors(before.lobes, with_prior.samples().grid);
  spec.D = before.D;
  spec.F = before.F;
  spec.G = before.G;
  return {"isotropic instead of anisotropic",
          {WithAxes(Rounded(model), spec),
           FindInitialModel("analytic").make(Objective(with_prior, spec), 0)}};
}

// Prune, within what is left of the budget.
PrunedModel PruneFurther(const Pruning& pruning, PruneOptions options) {
  const PruneState& state = pruning.state();
  if (!pruning.by_parameters()) {
    if (state.E > 0) options.max_relative_rise = std::max(pruning.limit() / state.E - 1, 0.0);
    if (pruning.limits_error() && !options.error) {
      const double growth = pruning.max_error() / pruning.ErrorOf(state);
      options.max_psnr_drop_db = std::max(20 * std::log10(growth), 0.0);
    }
  }
  options.max_error = pruning.max_error();
  PrunedModel further = Prune(*state.data, state.model, options);
  further.misses_budget = further.misses_budget || pruning.misses_budget();
  std::vector<PruneDecision> decisions = pruning.decisions();
  std::ranges::move(further.decisions, std::back_inserter(decisions));
  further.decisions = std::move(decisions);
  return further;
}

}  // namespace

PrunedModel PruneAnisotropic(const Objective& measured, const Objective& with_prior,
                             const FactorModel& full, const PruneOptions& options) {
  AnisotropicPruning search(measured, with_prior, full, options);
  Pruning& pruning = search.pruning();
  if (!pruning.KeepsToBudget(pruning.state())) {
    pruning.Record(
        kWithinBudget, pruning.state(), false,
        "none was found, as an anisotropic one gets no lobe more; " + std::string(kSoughtInstead));
    pruning.SettleForState();
  }
  if (pruning.by_parameters()) {
    search.ReduceTo(options.max_parameters);
  } else if (pruning.may_rise()) {
    if (options.tables) {
      const Reduced isotropic = Isotropic(pruning.state().model, with_prior);
      if (search.Decide(isotropic.what, search.Fit(isotropic))) {
        return PruneFurther(pruning, options);
      }
    }
    search.ReduceWhatThereIs();
  }
  return pruning.Result(LobeOrder::kByLight);
}

}  // namespace trilobe
