#ifndef TRILOBE_CORE_MATH_LANES_H_
#define TRILOBE_CORE_MATH_LANES_H_

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/base/multiversion.h"

// How vectors are returned depends on the registers that there are; but all of these functions
// become part of their callers.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace trilobe {

// Four numbers side by side, which compile to whatever vector registers there are.
template <typename Real>
struct FourOf;
template <>
struct FourOf<double> {
  using Digit = std::int64_t;
  using Digits = std::int64_t __attribute__((vector_size(4 * sizeof(std::int64_t))));
  static constexpr double kLarge = 0x1.8p52;
  using Type = double __attribute__((vector_size(4 * sizeof(double))));
};
template <>
struct FourOf<float> {
  using Digit = std::int32_t;
  using Digits = std::int32_t __attribute__((vector_size(4 * sizeof(std::int32_t))));
  static constexpr float kLarge = 0x1.8p23F;
  using Type = float __attribute__((vector_size(4 * sizeof(float))));
};
template <typename Real>
using Four = typename FourOf<Real>::Type;

template <typename Real>
TRILOBE_ALWAYS_INLINE Four<Real> Load(const Real* from) {
  Four<Real> loaded;
  std::memcpy(&loaded, from, sizeof(loaded));
  return loaded;
}
template <typename Real>
TRILOBE_ALWAYS_INLINE void Store(const Four<Real>& from, Real* target) {
  std::memcpy(target, &from, sizeof(from));
}
template <typename Real>
TRILOBE_ALWAYS_INLINE Four<Real> Broadcast(Real x) {
  return Four<Real>{x, x, x, x};
}

template <typename Lanes>
TRILOBE_ALWAYS_INLINE Lanes MaxOf(const Lanes& a, const Lanes& b) {
  return a < b ? b : a;
}
template <typename Lanes>
TRILOBE_ALWAYS_INLINE Lanes MinOf(const Lanes& a, const Lanes& b) {
  return a < b ? a : b;
}
template <typename Lanes>
TRILOBE_ALWAYS_INLINE Lanes SqrtOf(const Lanes& x) {
  return Lanes{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

// Numbers in [0, 2^20] as whole parts k and rests, told as shares: such a number reads the share
// `lower` of entry k of a table, and `upper` of the next one. Of a whole number, k may be one less,
// and `upper` 1. By a sum so large that whole numbers are its last digits, which costs less than to
// convert there and back.
template <typename Real>
struct Parts {
  TRILOBE_ALWAYS_INLINE explicit Parts(const Four<Real>& less_half) {
    const Four<Real> sum = less_half + kLarge;
    const Four<Real> rest = less_half - (sum - kLarge);
    lower = Real{0.5} - rest;
    upper = Real{0.5} + rest;
    std::memcpy(&digits, &sum, sizeof(digits));
  }
  TRILOBE_ALWAYS_INLINE int whole(int lane) const { return static_cast<int>(digits[lane] - kZero); }

  static constexpr Real kLarge = FourOf<Real>::kLarge;
  static constexpr auto kZero = std::bit_cast<typename FourOf<Real>::Digit>(kLarge);
  Four<Real> lower, upper;
  typename FourOf<Real>::Digits digits;
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_MATH_LANES_H_
