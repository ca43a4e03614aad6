#ifndef TRILOBE_MODEL_MEASUREMENT_COUNTER_RANDOM_H_
#define TRILOBE_MODEL_MEASUREMENT_COUNTER_RANDOM_H_

#include <cmath>
#include <cstdint>

#include "trilobe/core/base/directions.h"

namespace trilobe {

// Random numbers as pure functions of a seed and a counter, computable in any order.

// Uniform in (0, 1): SplitMix64 (Steele, Lea, Flood 2014) at position `counter` of stream `seed`.
inline double UniformAt(uint64_t seed, uint64_t counter) {
  const auto mix = [](uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
  };
  const uint64_t bits = mix(mix(seed) + counter * 0x9e3779b97f4a7c15U);
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-53;
}

// Standard normal (Box and Muller 1958), from the uniform numbers at 2 counter and 2 counter + 1.
inline double NormalAt(uint64_t seed, uint64_t counter) {
  const double radius = std::sqrt(-2 * std::log(UniformAt(seed, 2 * counter)));
  return radius * std::cos(2 * kPi * UniformAt(seed, 2 * counter + 1));
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_COUNTER_RANDOM_H_
