#ifndef TRILOBE_CORE_BASE_RADICAL_INVERSE_H_
#define TRILOBE_CORE_BASE_RADICAL_INVERSE_H_

#include <cstddef>

namespace trilobe {

// The digits of n in a base, mirrored at the point, in [0, 1): n = 1, 2, ... are Halton's sequence
// in a dimension whose base is a prime of its own (Halton 1960), and van der Corput's in base 2.
inline double RadicalInverse(int base, size_t n) {
  double value = 0, digit = 1;
  const double step = 1.0 / base;
  for (; n > 0; n /= base) {
    digit *= step;
    value += digit * static_cast<double>(n % base);
  }
  return value;
}

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_RADICAL_INVERSE_H_
