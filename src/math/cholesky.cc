#include "trilobe/math/cholesky.h"

#include <algorithm>
#include <cstddef>
#include <vector>

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
constexpr int kTile = 80;

bool AnyNot0(int rows, int columns, size_t stride, const double* A) {
  for (int j = 0; j < columns; ++j) {
    for (int i = 0; i < rows; ++i) {
      if (A[j * stride + i] != 0) return true;
    }
  }
  return false;
}

// The lower triangle of a matrix in tiles, and which of them have any numbers in them.
class Tiles {
 public:
  // Tiles of a column that follow each other: [begin, end).
  struct Run {
    int begin, end;
  };

  Tiles(int n, double* A) : n_(n), A_(A), full_((n + kTile - 1) / kTile) {
    for (int j = 0; j < count(); ++j) {
      full_[j].resize(count());
      for (int i = j + 1; i < count(); ++i) full_[j][i] = AnyNot0(size(i), size(j), n_, at(i, j));
    }
  }

  int count() const { return static_cast<int>(full_.size()); }
  int size(int i) const { return std::min(kTile, n_ - i * kTile); }
  int rows(const Run& run) const { return std::min(n_, run.end * kTile) - run.begin * kTile; }
  double* at(int i, int j) const {
    return A_ + static_cast<size_t>(j) * kTile * n_ + static_cast<size_t>(i) * kTile;
  }

  // Those below the diagonal that are not all 0; what a column takes from the tiles right of it
  // fills these, wherever both of two are among its own.
  std::vector<int> Below(int k) {
    std::vector<int> below;
    for (int i = k + 1; i < count(); ++i) {
      if (!full_[k][i]) continue;
      for (const int j : below) full_[j][i] = true;
      below.push_back(i);
    }
    return below;
  }

 private:
  const int n_;
  double* const A_;
  std::vector<std::vector<bool>> full_;  // by column and row
};

// Right-looking, a column of tiles at a time: its tile on the diagonal, those below it, and what
// these take from the tiles right of it. Tiles that are 0, and stay so, are left out. Each tile is
// one thread's, whatever the number of threads.
bool FactorByTiles(int n, double* A, int num_threads) {
  const double one = 1, minus_one = -1;
  Tiles tiles(n, A);
  for (int k = 0; k < tiles.count(); ++k) {
    const int width = tiles.size(k);
    int info = 0;
    {
      const BlasCall call;
      dpotrf_("L", &width, tiles.at(k, k), &n, &info);
    }
    if (info != 0) return false;
    const std::vector<int> below = tiles.Below(k);
    const int count = static_cast<int>(below.size());
    ParallelFor(count, num_threads, [&](int t) {
      const int i = below[t], height = tiles.size(i);
      const BlasCall call;
      dtrsm_("R", "L", "T", "N", &height, &width, &one, tiles.at(k, k), &n, tiles.at(i, k), &n);
    });
    ParallelFor(count, num_threads, [&](int t) {
      const int j = below[t], columns = tiles.size(j);
      const BlasCall call;
      dsyrk_("L", "N", &columns, &width, &minus_one, tiles.at(j, k), &n, &one, tiles.at(j, j), &n);
      // Those below it in one call for each run.
      for (int i = t + 1; i < count;) {
        Tiles::Run run{below[i], below[i] + 1};
        while (++i < count && below[i] == run.end) ++run.end;
        const int rows = tiles.rows(run);
        dgemm_("N", "T", &rows, &columns, &width, &minus_one, tiles.at(run.begin, k), &n,
               tiles.at(j, k), &n, &one, tiles.at(run.begin, j), &n);
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
