#ifndef TRILOBE_SOLVERS_AWLS_LITERAL_H_
#define TRILOBE_SOLVERS_AWLS_LITERAL_H_

#include "trilobe/solvers/solver.h"

namespace trilobe {

// The paper's alternating weighted least squares (2.3), as one would write it on the board: for
// each element in turn, loop over the samples that read it, and put it where E is lowest. Works on
// any samples and spec. The reference that the fast `awls` is checked against.
class AwlsLiteral : public Solver {
 public:
  SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                      FactorModel* model) const override;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_LITERAL_H_
