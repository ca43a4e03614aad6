#include "trilobe/fit/finish/synthetic_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "fit/finish/dim_highlights.h"
#include "fit/finish/node_residual.h"
#include "model/measurement/join_samples.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

constexpr int kDataPerSample = 6;  // samples of the data for one of the prior
// If these are fewer than kFew per parameter of the model, there are kEnough per parameter, which
// then count less: few data leave many parameters to the prior.
constexpr int kFew = 3, kEnough = 6;
// With few data, values of the prior are limited to this multiple of the largest measured value.
constexpr double kMaxOfLargest = 2;
// A fit overshoots if it exceeds this multiple of the largest value, of which the prior may say
// half at most.
constexpr double kOvershoot = 2 * kMaxOfLargest;
// With fewer samples than this per parameter of a prior, it needs one itself, on fewer nodes.
constexpr int kSamplesPerParameter = 5;

// A second lobe is worth its parameters if it leaves less than this share of E: 0.03 and 0.25 where
// two kinds of threads, or a coat and its base, reflect; 0.49 and more elsewhere, where it gains 2
// dB between the samples at most and may lose 22 (docs/forms.md).
constexpr double kWorthALobe = 0.4;

// Forms, start and weight of a prior, with and without measured azimuths.
struct PriorKind {
  std::vector<ModelSpec> specs;  // of one lobe, from fine to coarse
  const char* start;
  double weight;  // what it counts
};
PriorKind KindFor(const SyntheticPriorOptions& options, int lobes) {
  lobes = std::min(lobes, 1);  // none for models without
  PriorKind kind;
  if (options.isotropic) {
    kind = {.specs = {}, .start = "analytic", .weight = 0.003 * options.weight};
    for (const auto& [d, f, g] : {std::array{24, 6, 9}, {12, 4, 6}, {8, 4, 4}}) {
      ModelSpec& spec = kind.specs.emplace_back(ModelSpec::SharedFactors(lobes));
      spec.d_axis.size = d;
      spec.f_axis.size = f;
      spec.g_axis.size = g;
    }
    return kind;
  }
  kind = {.specs = {}, .start = "moments", .weight = options.weight};
  for (const auto& [d_theta, d_phi, f, g_theta, g_phi] :
       {std::array{12, 24, 6, 6, 8}, {8, 12, 4, 4, 4}, {6, 6, 4, 3, 2}, {6, 2, 4, 3, 2}}) {
    ModelSpec& spec = kind.specs.emplace_back(ModelSpec::Anisotropic(lobes));
    spec.d_axis = Axis::EvenPolar(d_theta, Axis::Steps::kOfRoot, d_phi);
    spec.f_axis.size = f;
    spec.g_axis = Axis::EvenPolar(g_theta, Axis::Steps::kOfTheta, g_phi);
  }
  return kind;
}

// In each channel, to so many times the largest of the data.
void LimitTo(double times, const std::vector<Rgb>& data, std::vector<Rgb>* rho) {
  for (int c = 0; c < 3; ++c) {
    double largest = 0;
    for (const Rgb& value : data) largest = std::max(largest, value[c]);
    for (Rgb& value : *rho) value[c] = std::min(value[c], times * largest);
  }
}

// A prior as it is fitted, and the residual of the data at their nodes, if they have any.
struct PriorModel {
  const FactorModel& model;
  const NodeBrdf* residual = nullptr;
};

// Samples of the prior at these directions.
BrdfSamples SamplesOf(const PriorModel& prior, std::vector<SphericalAngles> directions,
                      const BrdfSamples& measured, int num_threads) {
  BrdfSamples added;
  added.source = measured.source;
  added.grid = measured.grid;
  added.directions = std::move(directions);
  for (const SphericalAngles& at : added.directions) {
    added.angles.push_back(ToHalfDiff(ToDirections(at)));
  }
  added.rho.assign(added.directions.size(), {});
  added.rho = EvaluateSamples(prior.model, added, num_threads);
  if (prior.residual == nullptr) return added;
  for (size_t j = 0; j < added.rho.size(); ++j) {
    const Rgb residual = (*prior.residual)(added.directions[j]);
    for (int c = 0; c < kChannels; ++c) {
      added.rho[j][c] = std::max(added.rho[j][c] + residual[c], 0.0);
    }
  }
  return added;
}

// Directions between the samples where a fit is above so many times their largest value.
std::vector<SphericalAngles> FindDirectionsAbove(double times, const Objective& with_prior,
                                                 const FactorModel& fit) {
  const BrdfSamples& measured = with_prior.data().samples();
  return DirectionsAbove(times * LargestValue(measured), LargestTheta(measured), fit,
                         with_prior.num_threads());
}

// Samples of `prior` between those of the data, enough for a model of so many parameters.
BrdfSamples SamplesBetween(const PriorModel& prior, const Objective& data, int num_parameters,
                           double weight) {
  const BrdfSamples& measured = data.samples();
  const double share = static_cast<double>(measured.rho.size()) / kDataPerSample;
  const bool few = share < kFew * num_parameters;
  const auto count = static_cast<size_t>(few ? kEnough * num_parameters : share);
  BrdfSamples added =
      SamplesOf(prior,
                DirectionsBetween(LargestTheta(measured), count,
                                  few ? Spread::kRetroreflectionToo : Spread::kByHighlights),
                measured, data.num_threads());
  if (few) {
    LimitTo(kMaxOfLargest, measured.rho, &added.rho);
    weight *= share / static_cast<double>(count);
  }
  added.multiplicity.assign(added.rho.size(), weight);
  return added;
}

BrdfSamples WithSamplesOf(const PriorModel& prior, const Objective& data, int num_parameters,
                          double weight) {
  const BrdfSamples added = SamplesBetween(prior, data, num_parameters, weight);
  return added.size() == 0 ? data.samples() : JoinSamples(data.samples(), added);
}

// The prior of this number, from 0 (the finest), itself fitted with the next where data are few.
FactorModel FitPrior(const PriorKind& kind, size_t number, const Objective& data,
                     const StopCheck& stop) {
  const ModelSpec& spec = kind.specs[number];
  const int n = spec.num_parameters();
  const bool with_prior =
      data.samples().size() < kSamplesPerParameter * n && number + 1 < kind.specs.size();
  const Objective objective =
      with_prior ? Objective(WithSamplesOf({FitPrior(kind, number + 1, data, stop)}, data, n,
                                           /*weight=*/1),
                             spec, data.weighting(), data.num_threads())
                 : Objective(data, spec);
  FactorModel model = FindInitialModel(kind.start).make(objective, 0);
  SolverOptions options;
  options.diagnose = false;
  options.stop = stop;
  MakeSolver("varpro")->Solve(objective, options, &model);
  return model;
}

// Replaces the model by one with two lobes, if they are worth it.
void TryTwoLobes(PriorKind* kind, const Objective& data, const StopCheck& stop,
                 FactorModel* model) {
  for (ModelSpec& spec : kind->specs) spec.lobes = 2;
  // With few samples the second lobe would follow the noise.
  if (data.samples().size() < kSamplesPerParameter * kind->specs.front().num_parameters()) return;
  FactorModel two = FitPrior(*kind, 0, data, stop);
  const auto E = [&](const FactorModel& fitted) {
    return Objective(data, fitted.spec()).Value(fitted);
  };
  if (!stop() && E(two) < kWorthALobe * E(*model)) *model = std::move(two);
}

// Adds samples of the prior where the fit overshoots, with growing weight, and refits.
void LowerOvershoot(const SyntheticPrior& prior, const StopCheck& stop, Objective* with_prior,
                    FactorModel* model) {
  constexpr int kRounds = 4, kSteps = 20;
  constexpr double kMore = 10;  // of what each of the prior's samples there counts, each round
  SolverOptions options;
  options.max_iterations = kSteps;
  options.diagnose = false;
  options.on_iteration = [&](const IterationRecord&, const FactorModel&) { return !stop(); };
  double times = 1;
  for (int round = 0; round < kRounds && !stop(); ++round, times *= kMore) {
    if (!prior.AddWhereLarge(*model, times, with_prior)) break;
    MakeSolver("varpro")->Solve(*with_prior, options, model);
  }
}

}  // namespace

SyntheticPrior::SyntheticPrior(const Objective& data, const SyntheticPriorOptions& options) {
  const BrdfSamples& measured = data.samples();
  if (!(options.weight > 0 && std::isfinite(options.weight))) {
    throw ErrorIn(ErrorKind::kRange, measured.source,
                  "the weight of a prior must be finite and above 0")
        .About("weight", options.weight);
  }
  if (measured.directions.empty()) {
    throw ErrorIn(ErrorKind::kMissing, measured.source,
                  "a prior needs samples with their directions")
        .About("directions");
  }
  PriorKind kind = KindFor(options, data.spec().lobes);
  weight_ = kind.weight;
  model_ = FitPrior(kind, 0, data, options.stop);
  if (options.isotropic) {
    Objective objective(data, model_.spec());
    DimHighlights(options.stop, &objective, &model_);
  } else if (data.spec().lobes >= 2) {
    TryTwoLobes(&kind, data, options.stop, &model_);
  }
  if (options.grid) residual_ = InterpolateResidual(model_, data, *options.grid);
}

BrdfSamples SyntheticPrior::JoinTo(const Objective& data) const {
  return WithSamplesOf({model_, residual_ ? &*residual_ : nullptr}, data,
                       data.spec().num_parameters(), weight_);
}

Objective SyntheticPrior::Join(const Objective& data) const {
  BrdfSamples added = SamplesBetween({model_, residual_ ? &*residual_ : nullptr}, data,
                                     data.spec().num_parameters(), weight_);
  const double weight = added.size() == 0 ? 1 : added.multiplicity.front();
  return {data, std::move(added), weight};
}

bool SyntheticPrior::AddWhereLarge(const FactorModel& fit, double times,
                                   Objective* with_prior) const {
  const BrdfSamples& measured = with_prior->data().samples();
  const std::vector<SphericalAngles> large = FindDirectionsAbove(kMaxOfLargest, *with_prior, fit);
  if (large.empty()) return false;
  BrdfSamples added = SamplesOf({model_, residual_ ? &*residual_ : nullptr}, large, measured,
                                with_prior->num_threads());
  LimitTo(kMaxOfLargest, measured.rho, &added.rho);
  *with_prior = Objective(std::move(*with_prior), std::move(added), times * weight_);
  return true;
}

BrdfSamples WithPrior(const Objective& data, const SyntheticPriorOptions& options) {
  return SyntheticPrior(data, options).JoinTo(data);
}

std::optional<CorrectedOvershoot> CorrectOvershoot(const SyntheticPrior& prior,
                                                   const StopCheck& stop, Objective* with_prior,
                                                   FactorModel* model) {
  const double before = with_prior->data().Value(*model);
  bool changed = false;
  if (!FindDirectionsAbove(kOvershoot, *with_prior, *model).empty()) {
    LowerOvershoot(prior, stop, with_prior, model);
    changed = true;
  }
  if (!model->spec().anisotropic()) changed |= DimHighlights(stop, with_prior, model);
  if (!changed) return std::nullopt;
  return CorrectedOvershoot{before, with_prior->data().Value(*model)};
}

}  // namespace trilobe
