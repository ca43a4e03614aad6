#include "trilobe/solvers/cholesky.h"

#include <algorithm>

// LAPACK has no C header of its own.
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* A, const int* lda, int* info);
void dpotrs_(const char* uplo, const int* n, const int* nrhs, const double* A, const int* lda,
             double* B, const int* ldb, int* info);
}

namespace trilobe {

bool FactorCholesky(int n, double* A) {
  const int stride = std::max(1, n);
  int info = 0;
  dpotrf_("L", &n, A, &stride, &info);
  return info == 0;
}

void SolveCholesky(int n, const double* L, double* b) {
  const int stride = std::max(1, n), one = 1;
  int info = 0;
  dpotrs_("L", &n, &one, L, &stride, b, &stride, &info);
}

}  // namespace trilobe
