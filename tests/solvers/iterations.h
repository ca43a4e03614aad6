#ifndef TRILOBE_TESTS_SOLVERS_ITERATIONS_H_
#define TRILOBE_TESTS_SOLVERS_ITERATIONS_H_

#include <limits>

#include "trilobe/solvers/solver.h"

namespace trilobe {

// A tolerance that no decrease is below.
inline constexpr double kNever = -std::numeric_limits<double>::infinity();

// Options for `count` iterations, without a diagnosis.
inline SolverOptions Iterations(int count) {
  SolverOptions options;
  options.max_iterations = count;
  options.relative_decrease_tolerance = kNever;
  options.diagnose = false;
  return options;
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_SOLVERS_ITERATIONS_H_
