#include "trilobe/math/cholesky.h"

#include <algorithm>
#include <cstddef>

#include "trilobe/base/parallel.h"
#include "trilobe/math/openblas.h"
#include "trilobe/math/triangle.h"

// LAPACK has no C header of its own.
extern "C" {
void dpotrf_(const char* uplo, const int* n, double* A, const int* lda, int* info);
void dpotri_(const char* uplo, const int* n, double* A, const int* lda, int* info);
void dtrtrs_(const char* uplo, const char* trans, const char* diag, const int* n, const int* nrhs,
             const double* A, const int* lda, double* B, const int* ldb, int* info);
void dtrsm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
            const int* n, const double* alpha, const double* A, const int* lda, double* B,
            const int* ldb);
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha,
            const double* A, const int* lda, const double* beta, double* C, const int* ldc);
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
            const double* alpha, const double* A, const int* lda, const double* B, const int* ldb,
            const double* beta, double* C, const int* ldc);
}

namespace trilobe {
namespace {

void SolveTriangular(const char* trans, int n, const double* L, int columns, double* B) {
  const int stride = std::max(1, n);
  int info = 0;
  const BlasCall call;
  dtrtrs_("L", trans, "N", &n, &columns, L, &stride, B, &stride, &info);
}

// Below this tiles are not worth their while.
constexpr int kMinTiled = 1024;
constexpr int kTile = 192;

// Right-looking, a column of tiles at a time: its tile on the diagonal, those below it, and what
// these take from the tiles right of it. Each tile is one thread's, whatever the number of threads.
bool FactorByTiles(int n, double* A, int num_threads) {
  const double one = 1, minus_one = -1;
  const int tiles = (n + kTile - 1) / kTile;
  const auto size = [n](int i) { return std::min(kTile, n - i * kTile); };
  const auto tile = [&](int i, int j) {
    return A + static_cast<size_t>(j) * kTile * n + static_cast<size_t>(i) * kTile;
  };
  for (int k = 0; k < tiles; ++k) {
    const int width = size(k), below = tiles - k - 1;
    int info = 0;
    {
      const BlasCall call;
      dpotrf_("L", &width, tile(k, k), &n, &info);
    }
    if (info != 0) return false;
    ParallelFor(below, num_threads, [&](int t) {
      const int i = k + 1 + t, height = size(i);
      const BlasCall call;
      dtrsm_("R", "L", "T", "N", &height, &width, &one, tile(k, k), &n, tile(i, k), &n);
    });
    ParallelFor(below * (below + 1) / 2, num_threads, [&](int t) {
      int j = k + 1, row = t;  // the t-th of the tiles in the lower triangle, column by column
      for (; row >= tiles - j; ++j) row -= tiles - j;
      const int i = j + row, height = size(i), columns = size(j);
      const BlasCall call;
      if (i == j) {
        dsyrk_("L", "N", &height, &width, &minus_one, tile(i, k), &n, &one, tile(i, i), &n);
      } else {
        dgemm_("N", "T", &height, &columns, &width, &minus_one, tile(i, k), &n, tile(j, k), &n,
               &one, tile(i, j), &n);
      }
    });
  }
  return true;
}

}  // namespace

bool FactorCholesky(int n, double* A, int num_threads) {
  if (n > kMinTiled) return FactorByTiles(n, A, num_threads);
  const int stride = std::max(1, n);
  int info = 0;
  const BlasCall call;
  dpotrf_("L", &n, A, &stride, &info);
  return info == 0;
}

void InvertFactored(int n, double* L) {
  const int stride = std::max(1, n);
  int info = 0;
  {
    const BlasCall call;
    dpotri_("L", &n, L, &stride, &info);
  }
  MirrorTriangle(Triangle::kUpper, n, L);  // by rows it is the upper one that LAPACK has set
}

void SolveLower(int n, const double* L, int columns, double* B) {
  SolveTriangular("N", n, L, columns, B);
}

void SolveLowerTransposed(int n, const double* L, double* b) { SolveTriangular("T", n, L, 1, b); }

}  // namespace trilobe
