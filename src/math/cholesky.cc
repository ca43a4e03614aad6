#include "trilobe/math/cholesky.h"

#include <algorithm>
#include <cstddef>

// LAPACK has no C header of its own.
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* A, const int* lda, int* info);
void dpotri_(const char* uplo, const int* n, double* A, const int* lda, int* info);
void dtrtrs_(const char* uplo, const char* trans, const char* diag, const int* n, const int* nrhs,
             const double* A, const int* lda, double* B, const int* ldb, int* info);
}

namespace trilobe {
namespace {

void SolveTriangular(const char* trans, int n, const double* L, int columns, double* B) {
  const int stride = std::max(1, n);
  int info = 0;
  dtrtrs_("L", trans, "N", &n, &columns, L, &stride, B, &stride, &info);
}

}  // namespace

bool FactorCholesky(int n, double* A) {
  const int stride = std::max(1, n);
  int info = 0;
  dpotrf_("L", &n, A, &stride, &info);
  return info == 0;
}

void InvertFactored(int n, double* L) {
  const int stride = std::max(1, n);
  int info = 0;
  dpotri_("L", &n, L, &stride, &info);
  for (int j = 0; j < n; ++j) {
    for (int i = j + 1; i < n; ++i) {
      L[static_cast<size_t>(i) * n + j] = L[static_cast<size_t>(j) * n + i];
    }
  }
}

void SolveLower(int n, const double* L, int columns, double* B) {
  SolveTriangular("N", n, L, columns, B);
}

void SolveLowerTransposed(int n, const double* L, double* b) { SolveTriangular("T", n, L, 1, b); }

}  // namespace trilobe
