#ifndef TRILOBE_CORE_ALGEBRA_SYMMETRIC_MATRIX_H_
#define TRILOBE_CORE_ALGEBRA_SYMMETRIC_MATRIX_H_

#include <cstddef>
#include <vector>

namespace trilobe {

// Uses LAPACK for matrices of a few hundred rows, and tiles for a few thousand.
// Thread-safe (openblas.h). Matrices are stored column by column.

// Overwrites the lower triangle of a symmetric matrix [n][n] with its Cholesky factor L; the upper
// triangle is neither read nor written. False, and no factor, if it is not positive definite. Large
// matrices use several threads, with the same bits for any number. In these, tiles that are 0 in A
// and L cost nothing: rows coupled to few others should come first, next to these.
bool FactorCholesky(int n, double* A, int num_threads = 1);

// Overwrites the factor L by both triangles of the inverse of L L'.
void InvertFactored(int n, double* L);

// Overwrites B [n][columns] with L^-1 B, b [n] with L^-T b. Rows of B before `first_row` are 0, and
// so are those of L^-1 B.
void SolveLower(int n, const double* L, int columns, double* B, int first_row = 0);
void SolveLowerTransposed(int n, const double* L, double* b);

// A triangle without the diagonal of a square matrix stored by rows.
enum class Triangle { kUpper, kLower };

// Makes A [n][n] symmetric by copying one triangle to the other.
void MirrorTriangle(Triangle from, size_t n, double* A, int num_threads = 1);

// Eigenvalues of a symmetric matrix [n][n] with finite entries, in ascending order, each to some n
// eps times the largest. Only its lower triangle is read.
std::vector<double> SymmetricEigenvalues(int n, std::vector<double> A);

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_SYMMETRIC_MATRIX_H_
