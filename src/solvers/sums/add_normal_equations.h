#ifndef TRILOBE_SOLVERS_SUMS_ADD_NORMAL_EQUATIONS_H_
#define TRILOBE_SOLVERS_SUMS_ADD_NORMAL_EQUATIONS_H_

#include "model/objective/batch_evaluator.h"
#include "solvers/sums/accumulators.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// Adds samples [begin, end) to the sums of w v r and w v v' (ScatteredEquations), stored by
// `layout`. Returns their part of E, the sum of w r^2.
//
// rho depends on d, s and the lookups a of D, F and, twice, G. An entry e with weight_e in a lookup
// has v = weight_e d rho / d a, and two entries of lookups a and b contribute
//   H += weight_e weight_f  (sum over channels of w  d rho / d a  d rho / d b).
// The bracket is computed once for all pairs (e, f). Products of two entries of one lookup go to
// one of the pair's two places, those of an entry with itself by half; readers add both places. For
// Hessian::kNewton, second derivatives are added to the products of lookups, and squared lengths
// are summed separately.
double AddNormalEquations(const BatchEvaluator& reader, const AccumulatorLayout& layout,
                          Hessian hessian, int begin, int end, double* sums);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_ADD_NORMAL_EQUATIONS_H_
