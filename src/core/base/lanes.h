#ifndef TRILOBE_CORE_BASE_LANES_H_
#define TRILOBE_CORE_BASE_LANES_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/base/multiversion.h"
#include "trilobe/core/base/angles.h"

// The calling convention of vectors depends on the registers available; but all these functions are
// inlined.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace trilobe {

// A vector of four numbers, compiled to the vector registers available.
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

// Splits x in [0, 2^20], given x - 1/2, into an entry k = floor(x) of a table and the weights
// `lower` of entry k and `upper` of the next. If x is an integer, k may be one less and `upper` 1.
// Adding kLarge, whose last digit is 1, rounds to an integer faster than a conversion and back.
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

// Arc functions of four numbers at once, by polynomials through Chebyshev points. The functions are
// analytic up to an interval's length from it, so each degree reduces the error by a factor of 5.8.

// asin(sqrt(m)) / sqrt(m) for m in [0, 1/2], within 5e-15; of floats 2e-8.
template <typename Real>
struct ArcSine {
  static constexpr std::array<double, 16> kTerms = {
      0.99999999999999701,    0.16666666666972135, 0.074999999483086277, 0.044642891587955104,
      0.030380744182298735,   0.02239732936987961, 0.017008204963862801, 0.017202259139663847,
      -0.0099823578414291223, 0.11291573948991551, -0.34939268545353525, 0.89986136484862839,
      -1.5600342262502613,    1.8513181107321274,  -1.3176509482678197,  0.45069616236483129};
};
template <>
struct ArcSine<float> {
  static constexpr std::array<double, 8> kTerms = {
      0.99999998871119623,  0.16666954671609344,  0.074881144418223269,  0.046480849462936874,
      0.016731388950467387, 0.075539753822219652, -0.090086216710774052, 0.10967398323879114};
};

// atan(a) / a over a^2, within 8e-15, of floats 2e-8.
template <typename Real>
struct ArcTangent {
  static constexpr std::array<double, 17> kTerms = {
      0.99999999999999241,  -0.3333333333289398,    0.19999999957481825,   -0.142857126460504,
      0.11111077584971772,  -0.090904896477990323,  0.07688811662401294,   -0.066461457902212536,
      0.057941923168818451, -0.049779966759550474,  0.040517789771250661,  -0.029589012194344371,
      0.018198570485395786, -0.0087924355422176355, 0.0030659957028108008, -0.00067741053996450764,
      7.0631426358880456e-5};
};
template <>
struct ArcTangent<float> {
  static constexpr std::array<double, 9> kTerms = {
      0.99999998178865573,  -0.33333036709286276,  0.19991872029109072,
      -0.14197797794085123, 0.10618370636953849,   -0.074568548260045474,
      0.042137623589193041, -0.015731249122183653, 0.002766283501762026};
};

// For 8, 9, 16 or 17 terms, with few dependent steps (Estrin's scheme).
template <size_t kSize, typename Number, typename Term>
TRILOBE_ALWAYS_INLINE Number Polynomial(const Term& term, const Number& x) {
  static_assert(kSize == 8 || kSize == 9 || kSize == 16 || kSize == 17);
  const Number x2 = x * x, x4 = x2 * x2;
  const auto eight = [&](size_t k) __attribute__((always_inline)) {
    const Number a = term(k) + term(k + 1) * x, b = term(k + 2) + term(k + 3) * x;
    const Number c = term(k + 4) + term(k + 5) * x, d = term(k + 6) + term(k + 7) * x;
    return (a + b * x2) + (c + d * x2) * x4;
  };
  if constexpr (kSize == 8) return eight(0);
  const Number x8 = x4 * x4;
  if constexpr (kSize == 9) return eight(0) + term(8) * x8;
  if constexpr (kSize == 16) return eight(0) + eight(8) * x8;
  return eight(0) + (eight(8) + term(16) * x8) * x8;
}

// Angles in [0, 90] degrees from the squares of their sines [rad]. Near 0 they have the precision
// of the squares, which a cosine would lose. Relative error 6e-15, of floats 1e-6.
template <typename Real>
TRILOBE_ALWAYS_INLINE Four<Real> AnglesOfSines2(const Four<Real>& sines2) {
  constexpr auto kTerms = ArcSine<Real>::kTerms;
  const auto term = [&](size_t k) __attribute__((always_inline)) {
    return Broadcast(static_cast<Real>(kTerms[k]));
  };
  const Four<Real> m = MinOf(sines2, Four<Real>{1 - sines2});
  const Four<Real> angles = SqrtOf(m) * Polynomial<kTerms.size(), Four<Real>>(term, m);
  return sines2 > Broadcast<Real>(0.5) ? static_cast<Real>(kPi / 2) - angles : angles;
}

// The same for a single angle.
template <typename Real>
TRILOBE_ALWAYS_INLINE Real AngleOfSine2(Real sine2) {
  constexpr auto kTerms = ArcSine<Real>::kTerms;
  const auto term = [&](size_t k) __attribute__((always_inline)) {
    return static_cast<Real>(kTerms[k]);
  };
  const Real m = std::max(std::min(sine2, 1 - sine2), Real{0});
  const Real angle = std::sqrt(m) * Polynomial<kTerms.size(), Real>(term, m);
  return sine2 > Real{0.5} ? static_cast<Real>(kPi / 2) - angle : angle;
}

// Angles in [0, 180] degrees from cosines [rad]: cos x = 1 - 2 sin^2 (x / 2). Clamped to [-1, 1].
template <typename Real>
TRILOBE_ALWAYS_INLINE Real AngleOfCosine(Real cosine) {
  return 2 * AngleOfSine2((1 - cosine) / 2);
}

// The azimuths of points (x, y) in turns, from 0 to 1; 0 where both are 0. Within 2e-15, of floats
// 1e-7.
template <typename Real>
TRILOBE_ALWAYS_INLINE Four<Real> Turns(const Four<Real>& x, const Four<Real>& y) {
  const Four<Real> zero{}, length_x = x < zero ? -x : x, length_y = y < zero ? -y : y;
  const Four<Real> large = MaxOf(length_x, length_y), small = MinOf(length_x, length_y);
  const Four<Real> a = small / MaxOf(large, Broadcast(std::numeric_limits<Real>::min()));
  constexpr auto kTerms = ArcTangent<Real>::kTerms;
  const auto term = [&](size_t k) __attribute__((always_inline)) {
    return Broadcast(static_cast<Real>(kTerms[k] * (0.5 / kPi)));
  };
  Four<Real> turns = a * Polynomial<kTerms.size(), Four<Real>>(term, Four<Real>{a * a});
  turns = length_y > length_x ? Real{0.25} - turns : turns;
  turns = x < zero ? Real{0.5} - turns : turns;
  return y < zero ? 1 - turns : turns;
}

// The sine of an angle in [0, pi] from its cosine; 0 if rounding takes that beyond 1.
template <typename Real>
inline Real SineOf(Real cosine) {
  return std::sqrt(std::max(1 - cosine * cosine, Real{0}));
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_LANES_H_
