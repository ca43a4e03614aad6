#include "fit/guess_error.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "fit/finish/albedo_limit.h"
#include "model/lobes/beyond_data.h"
#include "trilobe/core/math/angles.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {
namespace {

// The coverage without the last `width` [rad] of what is well covered in each table.
std::vector<double> HideEnds(std::span<const double> coverage, const FactorModel& model,
                             double width) {
  std::vector<double> hidden(coverage.begin(), coverage.end());
  const ModelSpec& spec = model.spec();
  for (const Factor factor : kFactors) {
    const Axis& axis = spec.axis(factor);
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const auto table = std::span(hidden).subspan(model.TableOffset(factor, t), axis.size);
      int last = axis.size - 1;
      while (last > 0 && !(table[last] > 0 && IsWellCovered(table, last))) --last;
      const double end = axis.Theta(last) - width;
      for (int k = 0; k < axis.size; ++k) {
        if (axis.Theta(k) > end) table[k] = 0;
      }
    }
  }
  return hidden;
}

SphereError CompareWhole(const FactorModel& model, const FactorModel& other,
                         const AppearanceOptions& options) {
  constexpr int kEvery = 4;  // tells the same as all pixels would
  const auto everything = [](const HalfDiffAngles&, const Cosines&) { return true; };
  const AngularBrdf materials[] = {MaterialOf(model).angular, MaterialOf(other).angular};
  const std::vector<RenderedImage> spheres =
      RenderSpheres(materials, DrawLights(EnvironmentOf(options), options.lights), options.size,
                    everything, options.num_threads, kEvery);
  return CompareSpheres(spheres[0], spheres[1]);
}

double SumInDecibels(double a, double b) {
  return -10 * std::log10(std::pow(10, -a / 10) + std::pow(10, -b / 10));
}

}  // namespace

std::optional<WholeSphere> EstimateWholeSphere(const Objective& data, const FactorModel& model,
                                               double measured_share, const SeenError& seen,
                                               const AppearanceOptions& options) {
  constexpr double kNextToAll = 0.98, kHidden = 1.0 / 3;
  if (!(measured_share < kNextToAll) || model.spec().anisotropic()) return std::nullopt;
  const double end = std::asin(std::pow(measured_share, 0.25));
  const double width = kHidden * (kPi / 2 - end);
  FactorModel rehearsed = model;
  ContinueBeyondData(HideEnds(data.coverage(), model, width), options.num_threads, &rehearsed);
  AlbedoLimits limits = AlbedoLimitsOf(data, model);
  limits.beyond_theta -= width;
  LimitAlbedo(limits, TableLayout::Full(model.spec()), options.num_threads, {}, &rehearsed);
  const SphereError guess = CompareWhole(model, rehearsed, options);
  return WholeSphere{.mean_delta_e = std::hypot(seen.mean_delta_e, guess.mean_delta_e),
                     .psnr_db = SumInDecibels(seen.psnr_db, guess.psnr_db)};
}

}  // namespace trilobe
