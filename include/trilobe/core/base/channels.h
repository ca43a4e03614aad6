#ifndef TRILOBE_CORE_BASE_CHANNELS_H_
#define TRILOBE_CORE_BASE_CHANNELS_H_

#include <algorithm>
#include <array>
#include <cmath>

namespace trilobe {

// Red, green and blue, always in this order.
inline constexpr int kChannels = 3;

inline constexpr const char* kChannelNames[kChannels] = {"red", "green", "blue"};

using Rgb = std::array<double, kChannels>;

inline double Mean(const Rgb& rgb) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

// Negative channels become 0.
inline Rgb AtLeastZero(const Rgb& rgb) {
  return {std::max(rgb[0], 0.0), std::max(rgb[1], 0.0), std::max(rgb[2], 0.0)};
}

// |a - b| / |b|, where b is the reference; 0 if b is black.
inline double RelativeDistance(const Rgb& a, const Rgb& b) {
  const double length = std::hypot(b[0], b[1], b[2]);
  return length > 0 ? std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / length : 0;
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_CHANNELS_H_
