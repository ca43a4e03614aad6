#include "trilobe/solvers/guide.h"

#include <gsl/gsl_qrng.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/base/stop_check.h"
#include "trilobe/brdf/directions.h"
#include "trilobe/model/reconstruct.h"
#include "trilobe/solvers/initial_model.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

constexpr int kDataPerSample = 6;  // samples of the data for one of the guide
// Where these are fewer than kFew for each of the model's parameters, there are kEnough for each,
// which then count less: few data leave many parameters to the guide.
constexpr int kFew = 3, kEnough = 6;
// Of few data, too, it says no more than so many times the largest value.
constexpr double kMaxOfLargest = 2;
// With fewer samples than so many for each parameter of a guide it needs one itself, on fewer
// nodes.
constexpr int kSamplesPerParameter = 5;

// What a guide is where azimuths were measured, and where not.
struct GuideKind {
  std::vector<ModelSpec> specs;  // of one lobe, from fine to coarse
  const char* start;
  double weight;  // what it counts
};
GuideKind KindFor(const GuideOptions& options, int lobes) {
  lobes = std::min(lobes, 1);  // none for models without
  GuideKind kind;
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

// Where the guide speaks: half vectors spaced as a highlight asks for, by the root of theta_h, and
// wi over the hemisphere, by Halton's sequence, as far from the normal as the data are. Few data
// leave all to it, retroreflection near the horizon as well, where hardly any of these are: half of
// the pairs are then about half vectors spread evenly in theta_h.
std::vector<SphericalAngles> PairsBetween(const BrdfSamples& data, size_t count, bool few) {
  double max_theta = 0;
  for (const SphericalAngles& at : data.directions) {
    max_theta = std::max({max_theta, at.theta_i, at.theta_o});
  }
  const std::unique_ptr<gsl_qrng, decltype(&gsl_qrng_free)> halton(
      gsl_qrng_alloc(gsl_qrng_halton, 4), gsl_qrng_free);
  std::vector<SphericalAngles> pairs;
  const size_t tries = 20 * count;
  for (size_t k = 0; k < tries && pairs.size() < count; ++k) {
    double u[4];
    gsl_qrng_get(halton.get(), u);
    SphericalAngles at;
    if (!few || k % 2 == 0) {
      const auto [wi, h] = ToDirections(SphericalAngles{max_theta * u[0], 2 * kPi * u[1],
                                                        max_theta * u[2] * u[2], 2 * kPi * u[3]});
      const double cosine = Dot(wi, h);
      Direction wo;
      for (int c = 0; c < 3; ++c) wo[c] = 2 * cosine * h[c] - wi[c];
      if (!(cosine > 0 && wo[2] > 0)) continue;
      at = ToSphericalAngles({wi, wo});
    } else {
      at = ToSphericalAngles(
          ToDirections(HalfDiffAngles{max_theta * u[2], max_theta * u[0] * u[0], kPi * u[1]}));
      at.phi_i += 2 * kPi * u[3];
      at.phi_o += 2 * kPi * u[3];
    }
    if (std::max(at.theta_i, at.theta_o) <= max_theta) pairs.push_back(at);
  }
  return pairs;
}

// In each channel, to so many times the largest of the data.
void LimitTo(double times, const std::vector<Rgb>& data, std::vector<Rgb>* rho) {
  for (int c = 0; c < 3; ++c) {
    double largest = 0;
    for (const Rgb& value : data) largest = std::max(largest, value[c]);
    for (Rgb& value : *rho) value[c] = std::min(value[c], times * largest);
  }
}

// The data and what `guide` says between them, enough for a model of so many parameters.
BrdfSamples WithSamplesOf(const FactorModel& guide, const Objective& data, int num_parameters,
                          double weight) {
  const BrdfSamples& measured = data.samples();
  const double share = static_cast<double>(measured.rho.size()) / kDataPerSample;
  const bool few = share < kFew * num_parameters;
  const auto count = static_cast<size_t>(few ? kEnough * num_parameters : share);
  BrdfSamples said;
  said.source = measured.source;
  said.grid = measured.grid;
  said.directions = PairsBetween(measured, count, few);
  if (said.directions.empty()) return measured;
  for (const SphericalAngles& at : said.directions) {
    said.angles.push_back(ToHalfDiff(ToDirections(at)));
  }
  said.rho.assign(said.directions.size(), {});
  said.rho = EvaluateSamples(guide, said, data.num_threads());
  for (Rgb& value : said.rho) {
    for (double& x : value) x = std::max(x, 0.0);  // a spline may undershoot
  }
  if (few) {
    LimitTo(kMaxOfLargest, measured.rho, &said.rho);
    weight *= share / static_cast<double>(count);
  }

  BrdfSamples both = measured;
  if (both.multiplicity.empty()) both.multiplicity.assign(measured.rho.size(), 1);
  both.multiplicity.resize(measured.rho.size() + said.rho.size(), weight);
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(said.angles, &both.angles);
  append(said.directions, &both.directions);
  append(said.rho, &both.rho);
  return both;
}

// The guide of this number, from 0 (the finest), itself guided by the next where data are few.
FactorModel FitGuide(const GuideKind& kind, size_t number, const Objective& data,
                     const StopCheck& stop) {
  const ModelSpec& spec = kind.specs[number];
  const int n = spec.num_parameters();
  const bool guided =
      data.samples().size() < kSamplesPerParameter * n && number + 1 < kind.specs.size();
  const Objective objective =
      guided ? Objective(WithSamplesOf(FitGuide(kind, number + 1, data, stop), data, n,
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

}  // namespace

BrdfSamples WithGuide(const Objective& data, const GuideOptions& options) {
  const BrdfSamples& measured = data.samples();
  if (!(options.weight > 0 && std::isfinite(options.weight))) {
    throw Error(measured.source + ": the weight of a guide must be finite and above 0");
  }
  if (measured.directions.empty()) {
    throw Error(measured.source + ": a guide needs samples with their directions");
  }
  const GuideKind kind = KindFor(options, data.spec().lobes);
  return WithSamplesOf(FitGuide(kind, 0, data, options.stop), data, data.spec().num_parameters(),
                       kind.weight);
}

}  // namespace trilobe
