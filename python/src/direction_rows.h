#ifndef TRILOBE_PYTHON_SRC_DIRECTION_ROWS_H_
#define TRILOBE_PYTHON_SRC_DIRECTION_ROWS_H_

#include <nanobind/ndarray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <sstream>
#include <string>

#include "trilobe/core/base/error.h"

namespace trilobe::python {

template <typename Real>
using Input =
    nanobind::ndarray<const Real, nanobind::ndim<2>, nanobind::c_contig, nanobind::device::cpu>;
// Rows of an input array; a single one counts for all.
template <typename Real, size_t kWidth>
class Rows {
 public:
  Rows(const Input<Real>& array, size_t count, const char* name)
      : data_(array.data()), step_(array.shape(0) == 1 ? 0 : kWidth) {
    if (array.shape(1) != kWidth || (array.shape(0) != count && array.shape(0) != 1)) {
      throw Error(ErrorKind::kMismatch,
                  std::string(name) + " does not have as many rows as there are results")
          .About(name, array.shape(0));
    }
  }

  std::array<Real, kWidth> operator[](size_t k) const {
    std::array<Real, kWidth> row;
    for (size_t a = 0; a < kWidth; ++a) row[a] = data_[k * step_ + a];
    return row;
  }

 protected:
  const Real* data_;
  size_t step_;
};

// Directions: of unit length whatever they are given as, and NaN, of which everything is NaN, if
// they are none: zero, infinite or NaN.
template <typename Real>
class Directions : Rows<Real, 3> {
 public:
  using Rows<Real, 3>::Rows;

  std::array<Real, 3> operator[](size_t k) const {
    std::array<Real, 3> w = Rows<Real, 3>::operator[](k);
    const Real square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    constexpr Real kRounding = static_cast<Real>(sizeof(Real) == 4 ? 2e-6 : 1e-12);
    if (std::abs(square - 1) <= kRounding) return w;
    // Scales by the largest component first, lest the square overflow or vanish.
    const Real largest = std::max({std::abs(w[0]), std::abs(w[1]), std::abs(w[2])});
    constexpr Real kNone = std::numeric_limits<Real>::quiet_NaN();
    if (!(largest > 0 && std::isfinite(largest))) return {kNone, kNone, kNone};
    for (Real& x : w) x /= largest;
    const Real length = std::sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    for (Real& x : w) x /= length;
    return w;  // NaN where a component is
  }
};

// 0, or NaN where one of the directions is none. Added to a result, which Bsdf has as 0 then.
template <typename Real>
Real NoneOf(const std::array<Real, 3>& wi, const std::array<Real, 3>& wo) {
  return 0 * (wi[0] + wo[0]);
}
template <typename Real>
Real NoneOf(const std::array<Real, 3>& w) {
  return 0 * w[0];
}

// Throws Error unless all are in [0, 1).
template <typename Real>
void CheckRandom(const Input<Real>& u) {
  const Real* const begin = u.data();
  const Real* const end = begin + u.size();
  const Real* const wrong = std::find_if(begin, end, [](Real x) { return !(x >= 0 && x < 1); });
  if (wrong == end) return;
  std::ostringstream text;
  text << *wrong;
  throw Error(ErrorKind::kRange, "u has " + text.str() +
                                     ", and random numbers must be from 0 to below 1; of float32, "
                                     "draw them as such, since a double below 1 may round to it")
      .About("u", *wrong);
}

}  // namespace trilobe::python

#endif  // TRILOBE_PYTHON_SRC_DIRECTION_ROWS_H_
