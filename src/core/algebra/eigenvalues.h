#ifndef TRILOBE_CORE_ALGEBRA_EIGENVALUES_H_
#define TRILOBE_CORE_ALGEBRA_EIGENVALUES_H_

#include <vector>

namespace trilobe {

// Eigenvalues of a symmetric matrix [n][n] with finite entries, in ascending order, each to some n
// eps times the largest; by LAPACK. Only its lower triangle, column by column, is read.
std::vector<double> SymmetricEigenvalues(int n, std::vector<double> A);

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_EIGENVALUES_H_
