#include "trilobe/model/measurement/albedo.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/geometry/merl_grid.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

constexpr int kPhiSteps = 180;

// Two-point Gauss-Legendre rule on [0, 1].
constexpr double kGaussNodes[] = {0.21132486540518712, 0.78867513459481288};

void AddScaled(const Rgb& value, double scale, Rgb* sum) {
  for (int c = 0; c < kChannels; ++c) (*sum)[c] += scale * value[c];
}

}  // namespace

Rgb DirectionalAlbedo(const BrdfFunction& brdf, double theta_i) {
  CheckNotEmpty(brdf, "brdf");
  if (!(theta_i >= 0 && theta_i < kPi / 2)) {
    throw Error("theta_i is " + std::to_string(theta_i) + "; it must be from 0 to below pi/2");
  }
  const MerlGrid grid;
  const Direction wi{std::sin(theta_i), 0, std::cos(theta_i)};
  Rgb albedo{};
  for (int k = 0; k < kPhiSteps; ++k) {
    const double phi = (k + 0.5) / kPhiSteps * 2 * kPi;
    const double cos_phi = std::cos(phi), sin_phi = std::sin(phi);
    // With psi = atan2(sin theta_i cos phi, cos theta_i), cos theta_o is proportional to
    // cos(2 theta_h - psi), and wi . h to cos(theta_h - psi).
    const double psi = std::atan2(wi[0] * cos_phi, wi[2]);
    const double end = (psi + kPi / 2) / 2;
    for (int bin = 0; bin < grid.theta_h && grid.ThetaH(bin) < end; ++bin) {
      const double from = grid.ThetaH(bin);
      const double width = std::min(grid.ThetaH(bin + 1), end) - from;
      for (const double node : kGaussNodes) {
        const double theta_h = from + node * width;
        const double sin_h = std::sin(theta_h), cos_h = std::cos(theta_h);
        const Direction h{sin_h * cos_phi, sin_h * sin_phi, cos_h};
        const double wi_dot_h = wi[0] * h[0] + wi[2] * h[2];
        const Direction wo{2 * wi_dot_h * h[0] - wi[0], 2 * wi_dot_h * h[1],
                           2 * wi_dot_h * h[2] - wi[2]};
        if (!(wo[2] > 0)) continue;  // rounding, at the very horizon
        AddScaled(brdf({wi, wo}), wo[2] * 4 * wi_dot_h * sin_h * width / 2, &albedo);
      }
    }
  }
  Rgb result{};
  AddScaled(albedo, 2 * kPi / kPhiSteps, &result);
  return result;
}

std::vector<Rgb> DirectionalAlbedos(const BrdfFunction& brdf, std::span<const double> theta_i,
                                    int num_threads) {
  std::vector<Rgb> albedo(theta_i.size());
  ParallelFor(static_cast<int>(theta_i.size()), num_threads,
              [&](int i) { albedo[i] = DirectionalAlbedo(brdf, theta_i[i]); });
  return albedo;
}

std::optional<double> AlbedoPassesOne(std::span<const double> theta_i, std::span<const Rgb> albedo,
                                      int channel) {
  if (theta_i.size() != albedo.size() || channel < 0 || channel >= kChannels) {
    throw Error("each angle needs an albedo of channel 0, 1 or 2; there are " +
                std::to_string(theta_i.size()) + " angles, " + std::to_string(albedo.size()) +
                " albedos, and channel " + std::to_string(channel));
  }
  for (size_t i = 0; i < albedo.size(); ++i) {
    const double here = albedo[i][channel];
    if (!(here > 1)) continue;
    if (i == 0) return theta_i[0];
    const double before = albedo[i - 1][channel];
    return theta_i[i - 1] + (1 - before) / (here - before) * (theta_i[i] - theta_i[i - 1]);
  }
  return std::nullopt;
}

}  // namespace trilobe
