#ifndef TRILOBE_MODEL_APPEARANCE_POINT_ERRORS_H_
#define TRILOBE_MODEL_APPEARANCE_POINT_ERRORS_H_

#include <algorithm>
#include <cmath>
#include <span>

#include "trilobe/core/base/channels.h"

namespace trilobe {

// Mean over points and channels of |log((1 + b) / (1 + b*))|, b = rho cos theta_i, and of
// |rho - rho*| / (rho* + 1e-3).
struct PointErrors {
  double log = 0, relative = 0;
  int points = 0;  // that were compared; of 0, the errors say nothing
};

struct PointErrorSum {
  double log = 0, relative = 0;
  int values = 0;

  void Add(const Rgb& measured, const Rgb& fitted, double cos_theta_i) {
    for (int c = 0; c < kChannels; ++c) {
      log += std::abs(std::log1p(fitted[c] * cos_theta_i) - std::log1p(measured[c] * cos_theta_i));
      relative += std::abs(fitted[c] - measured[c]) / (measured[c] + 1e-3);
    }
    values += kChannels;
  }
};

inline PointErrors MeanOf(std::span<const PointErrorSum> sums) {
  PointErrorSum total;
  for (const PointErrorSum& sum : sums) {
    total.log += sum.log;
    total.relative += sum.relative;
    total.values += sum.values;
  }
  const double n = std::max(total.values, 1);
  return {total.log / n, total.relative / n, total.values / kChannels};
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_POINT_ERRORS_H_
