#ifndef TRILOBE_BRDF_CHANNELS_H_
#define TRILOBE_BRDF_CHANNELS_H_

#include <array>

namespace trilobe {

// Red, green, blue, in this order everywhere.
inline constexpr int kChannels = 3;

inline constexpr const char* kChannelNames[kChannels] = {"red", "green", "blue"};

using Rgb = std::array<double, kChannels>;

inline double Mean(const Rgb& rgb) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

}  // namespace trilobe

#endif  // TRILOBE_BRDF_CHANNELS_H_
