#include "model/appearance/node_appearance.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "model/appearance/color.h"
#include "model/appearance/render_environment.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/appearance/view.h"

namespace trilobe {
namespace {

constexpr double kOneStep = 1.0 / 255;  // of an 8-bit picture

// The BRDF clamped at 0, as a renderer does.
SphericalBrdf Clamped(const SphericalBrdf& brdf) {
  CheckNotEmpty(brdf, "the material");
  return [&brdf](const SphericalAngles& at) {
    Rgb rho = brdf(at);
    for (double& x : rho) x = std::max(x, 0.0);
    return rho;
  };
}

// The measurement beside a fit. Linear values miss a highlight that is narrower than the steps
// between the nodes, where the fit may be right. So the measured material differs from the fit
// there by the same factor as at the nodes around, both interpolated linearly.
class BesideFit {
 public:
  // Keeps references. `fitted`: at least 0.
  BesideFit(const NodeBrdf& measured, const SphericalBrdf& fitted, int num_threads)
      : measured_(measured),
        fitted_(fitted),
        fitted_at_nodes_(AtNodesOf(measured, fitted, num_threads)) {}

  Rgb operator()(const SphericalAngles& at) const {
    Rgb rho = measured_(at);
    const Rgb fitted = fitted_(at), around = fitted_at_nodes_(at);
    for (int c = 0; c < kChannels; ++c) {
      if (around[c] > 0) rho[c] *= fitted[c] / around[c];
    }
    return rho;
  }

 private:
  const NodeBrdf& measured_;
  const SphericalBrdf& fitted_;
  const NodeBrdf fitted_at_nodes_;
};

BrdfFunction OfMeasured(const SphericalBrdf& brdf, const NodeBrdf& measured) {
  return [&brdf, &measured](const DirectionPair& pair) {
    const SphericalAngles at = ToSphericalAngles(pair);
    return measured.Measured(at) ? brdf(at) : Rgb{};
  };
}

// At a subset of pairs of nodes, or half a step of all angles beyond them.
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

RenderedImages RenderMeasured(const NodeBrdf& measured, std::span<const SphericalBrdf> brdfs,
                              const AppearanceOptions& options, bool whole_too = false) {
  return Render(
      ViewSphere(options.size), brdfs, DrawLights(EnvironmentOf(options), options.lights),
      [&measured](const SphericalAngles& at) { return measured.Measured(at); }, whole_too,
      options.num_threads);
}

// Compares measured and fitted on a small sphere: a cloth's formula is a thousand times slower than
// a table.
AppearanceReport::FromFormula CompareWithFormula(const NodeBrdf& measured,
                                                 std::span<const SphericalBrdf, 2> brdfs,
                                                 const BrdfFunction& formula,
                                                 AppearanceOptions options) {
  options.size = std::max(options.size / 3, 8);
  const SphericalBrdf rendered[] = {
      brdfs[0], brdfs[1], [&](const SphericalAngles& at) { return formula(ToDirections(at)); }};
  const auto [counted, whole] = RenderMeasured(measured, rendered, options, /*whole_too=*/true);
  return {.fitted = CompareSpheres(counted[2], counted[1]),
          .measured = CompareSpheres(counted[2], counted[0]),
          .whole = CompareSpheres(whole[2], whole[1])};
}

}  // namespace

Measurement ReconstructAtNodes(const FactorModel& model, const std::string& source,
                               const HemisphereGrid& grid) {
  CheckHemisphereGrid(grid);
  const SphericalBrdf brdf = MaterialOf(model).spherical;
  SampleCollector collector(source, "reconstruction of an anisotropic model");
  for (int i = 0; i < grid.nodes(); ++i) {
    for (int o = 0; o < grid.nodes(); ++o) {
      const SphericalAngles at = grid.Angles(i, o);
      Rgb rho = brdf(at);
      for (double& x : rho) {
        if (!std::isfinite(x)) {
          throw ErrorIn(ErrorKind::kData, source,
                        "the model's value overflows at nodes " + std::to_string(i) + " and " +
                            std::to_string(o) + "; its factors are too large")
              .About("model", "overflow");
        }
        x = std::max(x, 0.0);
      }
      collector.Add(at, rho);
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = true;
  return measurement;
}

NodeBrdf AtNodesOf(const NodeBrdf& measured, const SphericalBrdf& brdf, int num_threads) {
  NodeTable table = measured.table();
  const int nodes = table.grid.nodes();
  ParallelFor(nodes, num_threads, [&](int i) {
    for (int o = 0; o < nodes; ++o) {
      const size_t index = static_cast<size_t>(i) * nodes + o;
      if (table.present[index]) table.rho[index] = brdf(table.grid.Angles(i, o));
    }
  });
  return NodeBrdf(std::move(table));
}

NodeJudge::NodeJudge(const NodeBrdf& measured, const SphericalBrdf& about_right,
                     const AppearanceOptions& options)
    : measured_(measured),
      options_(options),
      lights_(DrawLights(EnvironmentOf(options), options.lights)) {
  const std::vector<Rgb> linear = RadianceOf(std::cref(measured));
  double luminance = 0;
  for (const Rgb& light : linear) luminance += Luminance(light);
  if (luminance > 0) exposure_ = kMeanLuminance * static_cast<double>(linear.size()) / luminance;
  reference_ = PictureOf(std::cref(measured));
  const std::vector<Rgb> fitted = PictureOf(about_right);
  const NodeBrdf at_nodes = AtNodesOf(measured, about_right, options.num_threads);
  const std::vector<Rgb> interpolated = PictureOf(std::cref(at_nodes));
  weights_.resize(reference_.size());
  for (size_t k = 0; k < weights_.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) {
      const double off = fitted[k][c] - interpolated[k][c];
      weights_[k][c] = 1 / (off * off + kOneStep * kOneStep);
    }
  }
}

double NodeJudge::operator()(const SphericalBrdf& fitted) const {
  const std::vector<Rgb> sphere = PictureOf(fitted);
  double squares = 0, weights = 0;
  for (size_t k = 0; k < sphere.size(); ++k) {
    for (int c = 0; c < kChannels; ++c) {
      const double off = sphere[k][c] - reference_[k][c];
      squares += weights_[k][c] * off * off;
      weights += weights_[k][c];
    }
  }
  return 10 * std::log10(weights / squares);
}

std::vector<Rgb> NodeJudge::RadianceOf(const SphericalBrdf& brdf) const {
  const RenderedImages images = Render(
      ViewSphere(options_.size), {&brdf, 1}, lights_,
      [this](const SphericalAngles& at) { return measured_.Measured(at); },
      /*whole_too=*/false, options_.num_threads);
  const RenderedImage& sphere = images.counted[0];
  std::vector<Rgb> light;
  for (size_t k = 0; k < sphere.radiance.size(); ++k) {
    if (sphere.coverage[k] > 0) light.push_back(sphere.radiance[k]);
  }
  return light;
}

std::vector<Rgb> NodeJudge::PictureOf(const SphericalBrdf& brdf) const {
  std::vector<Rgb> encoded = RadianceOf(brdf);
  for (Rgb& pixel : encoded) {
    for (double& x : pixel) x = EncodeSrgb(exposure_ * x);
  }
  return encoded;
}

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
  const SphericalBrdf clamped = Clamped(fitted);
  const BesideFit beside(measured, clamped, options.num_threads);
  const SphericalBrdf brdfs[] = {std::cref(beside), clamped};
  std::vector<RenderedImage> spheres = RenderMeasured(measured, brdfs, options).counted;
  return {std::move(spheres[0]), std::move(spheres[1])};
}

ImagePairs RenderPicture(const NodeBrdf& measured, const SphericalBrdf& fitted, Shape shape,
                         const AppearanceOptions& options) {
  const SphericalBrdf clamped = Clamped(fitted);
  const BesideFit beside(measured, clamped, options.num_threads);
  const SphericalBrdf brdfs[] = {std::cref(beside), clamped};
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
