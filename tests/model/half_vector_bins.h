#ifndef TRILOBE_TESTS_MODEL_HALF_VECTOR_BINS_H_
#define TRILOBE_TESTS_MODEL_HALF_VECTOR_BINS_H_

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/model/materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// Half vectors in bins of theta_h, narrow near the normal, and of phi_h. The sphere of wo itself
// would need bins as narrow as a mirror's peak.
struct HalfVectorBins {
  static constexpr int kTheta = 16, kPhi = 12, kCount = kTheta * kPhi;

  static int Of(const Direction& wi, const Direction& wo) {
    const Direction h = {wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2]};
    const double x = std::sqrt(std::atan2(std::hypot(h[0], h[1]), h[2]) / (kPi / 2));
    const double turns = std::atan2(h[1], h[0]) / (2 * kPi) + 0.5;
    return std::min(static_cast<int>(x * kTheta), kTheta - 1) * kPhi +
           std::min(static_cast<int>(turns * kPhi), kPhi - 1);
  }

  // The integral of value(wo) over the directions wo above the surface with half vectors in a bin.
  template <typename Value>
  static double Integral(const Direction& wi, int bin, const Value& value) {
    constexpr int kSteps = kSanitized ? 8 : 16;
    double sum = 0;
    const int ring = bin / kPhi;
    for (int a = 0; a < kSteps; ++a) {
      const double x = (ring + (a + 0.5) / kSteps) / kTheta, theta = kPi / 2 * x * x;
      for (int b = 0; b < kSteps; ++b) {
        const double phi = 2 * kPi * ((bin % kPhi + (b + 0.5) / kSteps) / kPhi - 0.5);
        const Direction h = DirectionAt(theta, phi);
        const double wi_h = Dot(wi, h);
        Direction wo;
        for (int k = 0; k < 3; ++k) wo[k] = 2 * wi_h * h[k] - wi[k];
        if (!(wi_h > 0 && wo[2] > 0)) continue;
        // d omega_o = 4 (wi . h) sin theta dtheta dphi, dtheta = pi x dx.
        sum += value(wo) * 4 * wi_h * std::sin(theta) * kPi * x;
      }
    }
    return sum / (kSteps * kSteps) / kTheta * (2 * kPi / kPhi);
  }
};

// Pearson's chi^2 of what is drawn against the density, as many standard deviations above what is
// expected; bins with little are taken together.
inline double ChiSquared(const std::vector<int>& counts, const std::vector<double>& expected) {
  double chi2 = 0, rest = 0;
  int degrees = -1, rest_count = 0;
  for (size_t k = 0; k < counts.size(); ++k) {
    if (expected[k] < 20) {
      rest += expected[k];
      rest_count += counts[k];
      continue;
    }
    chi2 += std::pow(counts[k] - expected[k], 2) / expected[k];
    ++degrees;
  }
  if (rest > 5) {
    chi2 += std::pow(rest_count - rest, 2) / rest;
    ++degrees;
  }
  return degrees > 0 ? (chi2 - degrees) / std::sqrt(2.0 * degrees) : 0;
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_MODEL_HALF_VECTOR_BINS_H_
