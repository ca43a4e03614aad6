#include "trilobe/solvers/guide.h"

#include <gsl/gsl_qrng.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/brdf/directions.h"
#include "trilobe/model/reconstruct.h"
#include "trilobe/solvers/initial_model.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

constexpr int kDataPerSample = 6;  // samples of the data for one of the guide

FactorModel FitGuide(const Objective& data, const std::function<bool()>& stop) {
  ModelSpec spec = ModelSpec::Anisotropic(std::min(data.spec().lobes, 1));
  spec.d_axis = Axis::EvenPolar(12, Axis::Steps::kOfRoot, 24);
  spec.f_axis.size = 6;
  spec.g_axis = Axis::EvenPolar(6, Axis::Steps::kOfTheta, 8);
  const Objective objective(data, spec);
  FactorModel model = FindInitialModel("moments").make(objective, 0);
  SolverOptions options;
  options.diagnose = false;
  options.on_iteration = [&](const IterationRecord&, const FactorModel&) { return !stop(); };
  MakeSolver("varpro")->Solve(objective, options, &model);
  return model;
}

// Where the guide speaks: half vectors spaced as a highlight asks for, by the root of theta_h, and
// wi over the hemisphere, by Halton's sequence, as far from the normal as the data are.
std::vector<SphericalAngles> PairsBetween(const BrdfSamples& data, size_t count) {
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
    const auto [wi, h] = ToDirections(
        SphericalAngles{max_theta * u[0], 2 * kPi * u[1], max_theta * u[2] * u[2], 2 * kPi * u[3]});
    const double cosine = Dot(wi, h);
    Direction wo;
    for (int c = 0; c < 3; ++c) wo[c] = 2 * cosine * h[c] - wi[c];
    if (!(cosine > 0 && wo[2] > 0)) continue;
    const SphericalAngles at = ToSphericalAngles({wi, wo});
    if (at.theta_o <= max_theta) pairs.push_back(at);
  }
  return pairs;
}

}  // namespace

BrdfSamples WithGuide(const Objective& data, const GuideOptions& options) {
  const BrdfSamples& measured = data.samples();
  if (measured.directions.empty()) {
    throw Error(measured.source + ": a guide needs samples with their directions");
  }
  if (!(options.weight > 0)) {
    throw Error(measured.source + ": the weight of a guide must be above 0");
  }
  BrdfSamples guide;
  guide.source = measured.source;
  guide.grid = measured.grid;
  guide.directions = PairsBetween(measured, measured.rho.size() / kDataPerSample);
  if (guide.directions.empty()) return measured;
  for (const SphericalAngles& at : guide.directions) {
    guide.angles.push_back(ToHalfDiff(ToDirections(at)));
  }
  guide.rho.assign(guide.directions.size(), {});
  guide.rho = EvaluateSamples(FitGuide(data, options.stop), guide, data.num_threads());

  BrdfSamples both = measured;
  if (both.multiplicity.empty()) both.multiplicity.assign(measured.rho.size(), 1);
  both.multiplicity.resize(measured.rho.size() + guide.rho.size(), options.weight);
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(guide.angles, &both.angles);
  append(guide.directions, &both.directions);
  append(guide.rho, &both.rho);
  return both;
}

}  // namespace trilobe
