#ifndef TRILOBE_SOLVERS_SUMS_PARAMETER_KIND_H_
#define TRILOBE_SOLVERS_SUMS_PARAMETER_KIND_H_

#include "trilobe/model/model_spec.h"

namespace trilobe {

// The kinds of a model's parameters, in their order; d and s are amplitudes.
enum class ParameterKind { kAmplitudes, kD, kF, kG };
constexpr ParameterKind KindOf(Factor factor) {
  return static_cast<ParameterKind>(1 + static_cast<int>(factor));
}
constexpr Factor FactorOf(ParameterKind kind) {
  return static_cast<Factor>(static_cast<int>(kind) - 1);
}

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_PARAMETER_KIND_H_
