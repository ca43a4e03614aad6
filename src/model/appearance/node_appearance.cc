#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "model/appearance/render_environment.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/view.h"

namespace trilobe {
namespace {

// As a renderer would have it, whatever the function: no light is taken away.
SphericalBrdf Clamped(const SphericalBrdf& brdf) {
  CheckNotEmpty(brdf, "the material");
  return [&brdf](const SphericalAngles& at) {
    Rgb rho = brdf(at);
    for (double& x : rho) x = std::max(x, 0.0);
    return rho;
  };
}

BrdfFunction OfMeasured(const SphericalBrdf& brdf, const NodeBrdf& measured) {
  return [&brdf, &measured](const DirectionPair& pair) {
    const SphericalAngles at = ToSphericalAngles(pair);
    return measured.Measured(at) ? brdf(at) : Rgb{};
  };
}

// At every few pairs of nodes, or half a step of all angles beyond them.
PointErrors CompareAtPoints(const NodeBrdf& measured, const SphericalBrdf& fitted, double steps,
                            int num_threads) {
  const HemisphereGrid& grid = measured.table().grid;
  const int nodes = grid.nodes();
  const int stride = 1 + 2 * (nodes / 200);  // odd, for some 30,000 of UTIA's pairs
  std::vector<PointErrorSum> sums(nodes);
  ParallelFor(nodes, num_threads, [&](int i) {
    for (int o = i % stride; o < nodes; o += stride) {
      const SphericalAngles at = grid.Angles(i, o, steps);
      if (steps == 0 ? measured.Measured(at) : measured.MeasuredAround(i, o)) {
        sums[i].Add(measured(at), fitted(at), std::cos(at.theta_i));
      }
    }
  });
  return MeanOf(sums);
}

std::vector<RenderedImage> RenderMeasured(const NodeBrdf& measured,
                                          std::span<const SphericalBrdf> brdfs,
                                          const AppearanceOptions& options) {
  return Render(
             ViewSphere(options.size), brdfs, DrawLights(EnvironmentOf(options), options.lights),
             [&measured](const SphericalAngles& at) { return measured.Measured(at); },
             /*whole_too=*/false, options.num_threads)
      .counted;
}

// Of measured and fitted, on a small sphere: a cloth's formula takes a thousand times as long as a
// table.
AppearanceReport::FromFormula CompareWithFormula(const NodeBrdf& measured,
                                                 std::span<const SphericalBrdf, 2> brdfs,
                                                 const BrdfFunction& formula,
                                                 AppearanceOptions options) {
  options.size = std::max(options.size / 3, 8);
  const SphericalBrdf rendered[] = {
      brdfs[0], brdfs[1], [&](const SphericalAngles& at) { return formula(ToDirections(at)); }};
  const std::vector<RenderedImage> images = RenderMeasured(measured, rendered, options);
  return {CompareSpheres(images[2], images[1]), CompareSpheres(images[2], images[0])};
}

}  // namespace

AppearanceReport CompareAppearance(const NodeBrdf& measured, const SphericalBrdf& fitted,
                                   const AppearanceOptions& options, const BrdfFunction& formula) {
  const SphericalBrdf brdfs[] = {std::cref(measured), Clamped(fitted)};
  AppearanceReport report;
  report.environment = EnvironmentOf(options).name;
  report.lights = options.lights;
  report.size = options.size;
  report.at_nodes = true;
  const ImagePair pair = RenderMeasuredPair(measured, fitted, options);
  report.sphere = CompareSpheres(pair.measured, pair.fitted);
  if (formula) report.from_formula = CompareWithFormula(measured, brdfs, formula, options);
  const double along_and_across[] = {0, kPi / 2};
  report.albedo = CompareAlbedos(OfMeasured(brdfs[0], measured), OfMeasured(brdfs[1], measured),
                                 along_and_across, options.num_threads);
  report.at_centers = CompareAtPoints(measured, brdfs[1], 0, options.num_threads);
  report.between_centers = CompareAtPoints(measured, brdfs[1], 0.5, options.num_threads);
  CheckFinite(report, measured.table().source);
  return report;
}

ImagePair RenderMeasuredPair(const NodeBrdf& measured, const SphericalBrdf& fitted,
                             const AppearanceOptions& options) {
  const SphericalBrdf brdfs[] = {std::cref(measured), Clamped(fitted)};
  std::vector<RenderedImage> spheres = RenderMeasured(measured, brdfs, options);
  return {std::move(spheres[0]), std::move(spheres[1])};
}

ImagePairs RenderPicture(const NodeBrdf& measured, const SphericalBrdf& fitted, Shape shape,
                         const AppearanceOptions& options) {
  const SphericalBrdf brdfs[] = {std::cref(measured), Clamped(fitted)};
  const Environment& environment = EnvironmentOf(options);
  const View view = shape == Shape::kSphere
                        ? ViewSphere(options.size)
                        : ViewCloth(options.size, DrawLights(environment, options.lights));
  return PairsOf(RenderUnder(
      environment, view, brdfs,
      [&measured](const SphericalAngles& at) { return measured.Measured(at); },
      options.num_threads));
}

}  // namespace trilobe
