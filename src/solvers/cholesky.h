#ifndef TRILOBE_SOLVERS_CHOLESKY_H_
#define TRILOBE_SOLVERS_CHOLESKY_H_

namespace trilobe {

// Overwrites the lower triangle of a symmetric matrix [n][n], column by column, with its Cholesky
// factor L (LAPACK's dpotrf); what lies above is neither read nor written. False, and no factor, if
// the matrix is not positive definite.
bool FactorCholesky(int n, double* A);

// Overwrites b [n] with the solution of L L' x = b.
void SolveCholesky(int n, const double* L, double* b);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_CHOLESKY_H_
