#ifndef TRILOBE_CORE_ALGEBRA_TRIANGLE_H_
#define TRILOBE_CORE_ALGEBRA_TRIANGLE_H_

#include <cstddef>

namespace trilobe {

// Of a square matrix that is stored row by row, without the diagonal.
enum class Triangle { kUpper, kLower };

// Makes A [n][n] symmetric: what is in one triangle goes to the other.
void MirrorTriangle(Triangle from, size_t n, double* A, int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_TRIANGLE_H_
