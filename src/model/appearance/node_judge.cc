#include "model/appearance/node_judge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "model/appearance/color.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/appearance/view.h"

namespace trilobe {
namespace {

constexpr double kOneStep = 1.0 / 255;  // of an 8-bit picture

// The material where the measurement has values.
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

}  // namespace

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

}  // namespace trilobe
