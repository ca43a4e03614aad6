#ifndef TRILOBE_CORE_ALGEBRA_SYMMETRIC_MATRIX_H_
#define TRILOBE_CORE_ALGEBRA_SYMMETRIC_MATRIX_H_

#include <cstddef>
#include <vector>

namespace trilobe {

// By LAPACK, for matrices of a few hundred rows, and by tiles for some thousand. May be called from
// any number of threads at once (openblas.h). Matrices are stored column by column.

// Overwrites the lower triangle of a symmetric matrix [n][n] with its Cholesky factor L; what lies
// above is neither read nor written. False, and no factor, if it is not positive definite.
// More than one thread helps with large ones; the same bits for any number of them. Of large ones,
// tiles that are 0 in A and in L cost nothing: rows that have products with few others should come
// first, and next to these.
bool FactorCholesky(int n, double* A, int num_threads = 1);

// Overwrites the factor L by both triangles of the inverse of L L'.
void InvertFactored(int n, double* L);

// Overwrites B [n][columns] with L^-1 B, b [n] with L^-T b. Rows of B before `first_row` are 0, and
// so are those of L^-1 B.
void SolveLower(int n, const double* L, int columns, double* B, int first_row = 0);
void SolveLowerTransposed(int n, const double* L, double* b);

// Of a square matrix that is stored row by row, without the diagonal.
enum class Triangle { kUpper, kLower };

// Makes A [n][n] symmetric: what is in one triangle goes to the other.
void MirrorTriangle(Triangle from, size_t n, double* A, int num_threads = 1);

// Eigenvalues of a symmetric matrix [n][n] with finite entries, in ascending order, each to some n
// eps times the largest. Only its lower triangle is read.
std::vector<double> SymmetricEigenvalues(int n, std::vector<double> A);

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_SYMMETRIC_MATRIX_H_
