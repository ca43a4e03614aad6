#ifndef TRILOBE_BENCHMARKS_GGX_H_
#define TRILOBE_BENCHMARKS_GGX_H_

#include <algorithm>
#include <array>
#include <cmath>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// What a renderer without a fitted model has: a Lambertian term and one GGX lobe (Walter et al.
// 2007; Schlick's F), sampled by visible normals from spherical caps (Dupuy and Benyoub 2023,
// 10.1111/cgf.14867). The interface of Bsdf.
struct Ggx {
  double alpha = 0.2;
  Rgb diffuse = {0.1, 0.08, 0.05};
  Rgb f0 = {0.04, 0.04, 0.04};
  double diffuse_part = 0.5;

  double Lambda(double cosine) const {
    return 0.5 * (std::sqrt(1 + alpha * alpha * (1 / (cosine * cosine) - 1)) - 1);
  }
  double D(double cos_h) const {
    const double t = cos_h * cos_h * (alpha * alpha - 1) + 1;
    return alpha * alpha / (kPi * t * t);
  }

  Rgb Value(const Direction& wi, const Direction& wo) const {
    if (!(wo[2] > 0 && wi[2] > 0)) return {};
    Direction h = {wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2]};
    const double length = std::sqrt(Dot(h, h));
    const double shape =
        D(h[2] / length) / (4 * wo[2] * wi[2] * (1 + Lambda(wo[2]) + Lambda(wi[2])));
    const double k = 1 - length / 2, k5 = k * k * k * k * k;
    Rgb rho;
    for (int c = 0; c < kChannels; ++c) rho[c] = diffuse[c] + shape * (f0[c] + (1 - f0[c]) * k5);
    return rho;
  }

  double Pdf(const Direction& wi, const Direction& wo) const {
    if (!(wo[2] > 0 && wi[2] > 0)) return 0;
    const Direction h = {wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2]};
    const double cos_h = h[2] / std::sqrt(Dot(h, h));
    return diffuse_part * wo[2] / kPi +
           (1 - diffuse_part) * D(cos_h) / (4 * wi[2] * (1 + Lambda(wi[2])));
  }

  struct Sample {
    Direction wo{};
    double pdf = 0;
    Rgb weight{};
  };
  Sample SampleWo(const Direction& wi, const std::array<double, 2>& u) const {
    Sample sample;
    const double phi = 2 * kPi * u[1];
    if (u[0] < diffuse_part) {
      const double r2 = u[0] / diffuse_part, r = std::sqrt(r2);
      sample.wo = {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r2)};
    } else {
      const double v = (u[0] - diffuse_part) / (1 - diffuse_part);
      Direction w = {alpha * wi[0], alpha * wi[1], wi[2]};
      const double length = std::sqrt(Dot(w, w));
      for (double& x : w) x /= length;
      const double z = (1 - v) * (1 + w[2]) - w[2], r = std::sqrt(std::max(1 - z * z, 0.0));
      Direction h = {alpha * (r * std::cos(phi) + w[0]), alpha * (r * std::sin(phi) + w[1]),
                     z + w[2]};
      const double scale = 1 / std::sqrt(Dot(h, h));
      for (double& x : h) x *= scale;
      const double twice = 2 * Dot(wi, h);
      for (int a = 0; a < 3; ++a) sample.wo[a] = twice * h[a] - wi[a];
    }
    if (!(sample.wo[2] > 0)) return sample;
    sample.pdf = Pdf(wi, sample.wo);
    sample.weight = Value(wi, sample.wo);
    for (double& x : sample.weight) x *= sample.wo[2] / sample.pdf;
    return sample;
  }
};

}  // namespace trilobe

#endif  // TRILOBE_BENCHMARKS_GGX_H_
