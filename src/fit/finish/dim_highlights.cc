#include "fit/finish/dim_highlights.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "fit/finish/shown_light.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/prepared_model.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

// Pairs of directions around the highlight of light from theta_i.
std::vector<DirectionPair> AroundHighlight(double theta_i) {
  const Direction wi = ToDirection({theta_i, 0});
  std::vector<DirectionPair> pairs;
  for (const double degrees : {0.0, 0.2, 0.6, 1.5, 4.0}) {
    for (const double phi : {0.0, kPi / 2, kPi}) {
      if (degrees == 0 && phi > 0) continue;
      const Direction h = ToDirection({DegreesToRadians(degrees), phi});
      const double cosine = Dot(wi, h);
      Direction wo;
      for (int c = 0; c < 3; ++c) wo[c] = 2 * cosine * h[c] - wi[c];
      if (cosine > 0 && wo[2] > 1e-3) pairs.push_back({wi, wo});
    }
  }
  return pairs;
}

// Samples around the highlights that are too bright, as bright as they may be. Light into
// directions beyond the samples is not theirs.
BrdfSamples DimmedHighlights(double limit, const BrdfSamples& measured, const FactorModel& model,
                             int num_threads) {
  constexpr double kEnough = 0.9;  // so that few rounds do
  constexpr double kStep = DegreesToRadians(2), kFarthest = DegreesToRadians(88);
  const PreparedModel<double> prepared(model);
  const double max_theta = LargestTheta(measured);
  std::vector<double> angles;
  for (int k = 0; k * kStep <= std::min(max_theta, kFarthest); ++k) angles.push_back(k * kStep);
  const double least_cosine = std::cos(max_theta);
  const std::vector<Rgb> albedos = DirectionalAlbedos(
      [&](const DirectionPair& pair) {
        return pair.wo[2] >= least_cosine ? prepared.Value(pair.wi, pair.wo) : Rgb{};
      },
      angles, num_threads);
  BrdfSamples dimmed;
  dimmed.source = measured.source;
  dimmed.grid = measured.grid;
  for (size_t k = 0; k < angles.size(); ++k) {
    const double excess = std::ranges::max(albedos[k]) / limit;
    if (!(excess > 1)) continue;
    for (const DirectionPair& pair : AroundHighlight(angles[k])) {
      dimmed.directions.push_back(ToSphericalAngles(pair));
      dimmed.angles.push_back(ToHalfDiff(pair));
      dimmed.rho.push_back(prepared.Value(pair.wi, pair.wo));
      for (double& x : dimmed.rho.back()) x *= kEnough / excess;
    }
  }
  return dimmed;
}

}  // namespace

bool DimHighlights(const StopCheck& stop, Objective* objective, FactorModel* model) {
  constexpr int kRounds = 4, kSteps = 10;
  constexpr double kWeight = 0.01, kMore = 10;
  const BrdfSamples& measured = objective->data().samples();
  const int threads = objective->num_threads();
  const double limit = LimitByShown(measured, *model, threads);
  SolverOptions options;
  options.max_iterations = kSteps;
  options.diagnose = false;
  options.stop = stop;
  double weight = kWeight;
  bool changed = false;
  for (int round = 0; round < kRounds && !stop(); ++round, weight *= kMore) {
    BrdfSamples dimmed = DimmedHighlights(limit, measured, *model, threads);
    if (dimmed.rho.empty()) break;
    changed = true;
    *objective = Objective(std::move(*objective), std::move(dimmed), weight);
    MakeSolver("varpro")->Solve(*objective, options, model);
  }
  return changed;
}

}  // namespace trilobe
