#ifndef TRILOBE_EXPERIMENTS_SAMPLING_ENVIRONMENT_SAMPLER_H_
#define TRILOBE_EXPERIMENTS_SAMPLING_ENVIRONMENT_SAMPLER_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "model/appearance/color.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/appearance/environment.h"

namespace trilobe {

// An environment of constant radiance in each pixel, from which directions of the world are drawn
// in proportion to what a pixel sends: its luminance times its solid angle.
class EnvironmentSampler {
 public:
  explicit EnvironmentSampler(const Environment& environment) : of_(environment) {
    double sum = 0;
    for (int row = 0; row < of_.height; ++row) {
      for (int column = 0; column < of_.width; ++column) {
        sum += Luminance(of_.radiance[At(row, column)]) * SolidAngle(row);
        cumulated_.push_back(sum);
      }
    }
  }

  Rgb Radiance(const Direction& w) const { return of_.radiance[PixelAt(w)]; }

  // [1/sr]
  double Pdf(const Direction& w) const {
    return Luminance(of_.radiance[PixelAt(w)]) / cumulated_.back();
  }

  // A direction and its density.
  std::pair<Direction, double> Draw(const std::array<double, 2>& u) const {
    const double target = u[0] * cumulated_.back();
    const auto found = std::upper_bound(cumulated_.begin(), cumulated_.end() - 1, target);
    const auto pixel = static_cast<int>(found - cumulated_.begin());
    const double before = pixel > 0 ? cumulated_[pixel - 1] : 0;
    const double within = std::clamp((target - before) / (*found - before), 0.0, 1.0);
    const int row = pixel / of_.width, column = pixel % of_.width;
    const double top = std::cos(kPi * row / of_.height);
    const double y = top + u[1] * (std::cos(kPi * (row + 1) / of_.height) - top);
    const double phi = 2 * kPi * (column + within) / of_.width;
    const double r = std::sqrt(std::max(0.0, 1 - y * y));
    return {{-r * std::sin(phi), y, r * std::cos(phi)},
            Luminance(of_.radiance[pixel]) / cumulated_.back()};
  }

 private:
  size_t At(int row, int column) const { return static_cast<size_t>(row) * of_.width + column; }
  double SolidAngle(int row) const {
    return 2 * kPi / of_.width *
           (std::cos(kPi * row / of_.height) - std::cos(kPi * (row + 1) / of_.height));
  }
  // The middle column is behind the object (-z); columns go around as a camera there sees them.
  size_t PixelAt(const Direction& w) const {
    double phi = std::atan2(-w[0], w[2]);
    if (phi < 0) phi += 2 * kPi;
    const int row = static_cast<int>(std::acos(std::clamp(w[1], -1.0, 1.0)) / kPi * of_.height);
    const int column = static_cast<int>(phi / (2 * kPi) * of_.width);
    return At(std::clamp(row, 0, of_.height - 1), std::clamp(column, 0, of_.width - 1));
  }

  const Environment& of_;
  std::vector<double> cumulated_;
};

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_SAMPLING_ENVIRONMENT_SAMPLER_H_
