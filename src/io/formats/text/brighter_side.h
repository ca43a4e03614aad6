#ifndef TRILOBE_IO_FORMATS_TEXT_BRIGHTER_SIDE_H_
#define TRILOBE_IO_FORMATS_TEXT_BRIGHTER_SIDE_H_

#include <array>
#include <cmath>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"

namespace trilobe {

// Samples of a plane, with signs: whether the samples near the mirror direction are brighter where
// theta_i and theta_o have the same sign, or different ones.
class BrighterSide {
 public:
  void Add(double theta_i, double theta_o, const Rgb& rho) {
    const double mean = Mean(rho);
    if (!(std::abs(theta_i) < kPi / 2 && std::abs(theta_o) < kPi / 2) || !(mean >= 0)) return;
    if (!std::isfinite(mean) || theta_o == 0) return;
    const bool same = std::signbit(theta_i) == std::signbit(theta_o);
    const bool near = std::abs(std::abs(theta_i) - std::abs(theta_o)) < DegreesToRadians(15);
    for (const bool nearby : {false, near}) {
      sum_[nearby][same] += mean;
      ++count_[nearby][same];
    }
    seen_[same] = true;
  }
  bool both() const { return seen_[0] && seen_[1]; }
  bool same() const {
    const bool near = count_[1][0] > 0 && count_[1][1] > 0;
    return sum_[near][1] * count_[near][0] >= sum_[near][0] * count_[near][1];
  }

 private:
  std::array<std::array<double, 2>, 2> sum_{}, count_{};  // [near the mirror direction][same sign]
  std::array<bool, 2> seen_{};
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_TEXT_BRIGHTER_SIDE_H_
