#ifndef TRILOBE_MODEL_CHANNELS_H_
#define TRILOBE_MODEL_CHANNELS_H_

#include <array>

namespace trilobe {

// Red, green, blue, in this order everywhere.
inline constexpr int kChannels = 3;

using Rgb = std::array<double, kChannels>;

}  // namespace trilobe

#endif  // TRILOBE_MODEL_CHANNELS_H_
