#ifndef TRILOBE_SOLVERS_AWLS_H_
#define TRILOBE_SOLVERS_AWLS_H_

#include "trilobe/solvers/solver.h"

namespace trilobe {

// Alternating weighted least squares (paper 2.3) from exact sums. The same element updates in the
// same order as AwlsLiteral, but a sweep passes over the samples once for d, s, D, F (CellSums) and
// once for each table of G (SplineMoments), instead of once for each element's share of them.
// Needs samples on a grid.
class Awls : public Solver {
 public:
  SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                      FactorModel* model) const override;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_H_
