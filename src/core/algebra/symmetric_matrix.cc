#include "core/algebra/symmetric_matrix.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <span>
#include <thread>
#include <vector>

#include "core/algebra/openblas.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"

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

// LAPACK has no C header of its own.
extern "C" void dsyev_(const char* jobz, const char* uplo, const int* n, double* A, const int* lda,
                       double* w, double* work, const int* lwork, int* info);

namespace trilobe {
namespace {

// Solves with the rows and columns of L from `first` on.
void SolveTriangular(const char* trans, int n, int first, const double* L, int columns, double* B) {
  const int stride = std::max(1, n), rows = n - first;
  int info = 0;
  const BlasCall call;
  dtrtrs_("L", trans, "N", &rows, &columns, L + static_cast<size_t>(first) * (n + 1), &stride,
          B + first, &stride, &info);
}

// Below this size tiles do not pay.
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

// The lower triangle of a matrix in tiles, and which of these are not 0.
class Tiles {
 public:
  Tiles(int n, double* A) : n_(n), A_(A), full_((n + kTile - 1) / kTile) {
    for (int j = 0; j < count(); ++j) {
      full_[j].resize(count());
      for (int i = j + 1; i < count(); ++i) full_[j][i] = AnyNot0(size(i), size(j), n_, at(i, j));
    }
  }

  int count() const { return static_cast<int>(full_.size()); }
  int size(int i) const { return std::min(kTile, n_ - i * kTile); }
  double* at(int i, int j) const {
    return A_ + static_cast<size_t>(j) * kTile * n_ + static_cast<size_t>(i) * kTile;
  }

  // The nonzero tiles of column k of L below the diagonal. Its update of the columns to its right
  // fills the tiles at the intersections of its rows.
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

// Left-looking factorisation by columns of tiles. A column is updated by those to its left, in
// order from left to right for any number of threads, and then factored. Tiles that stay 0 are
// skipped. A column is one item of ParallelFor, which must not throw: it waits for the columns to
// its left, which started earlier. It waits actively, since there are some fifty waits in a few
// milliseconds.
class FactorizationByTiles {
 public:
  FactorizationByTiles(int n, double* A) : n_(n), tiles_(n, A), done_(tiles_.count()) {
    for (int k = 0; k < tiles_.count(); ++k) below_.push_back(tiles_.Below(k));
  }

  bool Run(int num_threads) {
    { const BlasCall memory_is_there; }  // or throws here, as no item may
    ParallelFor(tiles_.count(), num_threads, [&](int j) {
      for (int k = 0; k < j; ++k) {
        const auto first = std::ranges::lower_bound(below_[k], j);
        if (first == below_[k].end() || *first != j) continue;
        while (!done_[k].load(std::memory_order_acquire)) std::this_thread::yield();
        if (!failed_) TakeFrom(j, k, {first, below_[k].end()});
      }
      if (!failed_ && !Factor(j)) failed_ = true;
      done_[j].store(true, std::memory_order_release);
    });
    return !failed_;
  }

 private:
  // Subtracts the update by tiles [j, ...) of column k from column j, from row j on.
  void TakeFrom(int j, int k, std::span<const int> rows) {
    const double one = 1, minus_one = -1;
    const int columns = tiles_.size(j), width = tiles_.size(k);
    const BlasCall call;
    dsyrk_("L", "N", &columns, &width, &minus_one, tiles_.at(j, k), &n_, &one, tiles_.at(j, j),
           &n_);
    // The tiles below it, in one call for each run of consecutive ones.
    for (size_t t = 1; t < rows.size();) {
      const int begin = rows[t];
      int end = begin + 1;
      while (++t < rows.size() && rows[t] == end) ++end;
      const int height = std::min(n_, end * kTile) - begin * kTile;
      dgemm_("N", "T", &height, &columns, &width, &minus_one, tiles_.at(begin, k), &n_,
             tiles_.at(j, k), &n_, &one, tiles_.at(begin, j), &n_);
    }
  }

  bool Factor(int j) {
    const double one = 1;
    const int width = tiles_.size(j);
    int info = 0;
    const BlasCall call;
    dpotrf_("L", &width, tiles_.at(j, j), &n_, &info);
    if (info != 0) return false;
    for (const int i : below_[j]) {
      const int height = tiles_.size(i);
      dtrsm_("R", "L", "T", "N", &height, &width, &one, tiles_.at(j, j), &n_, tiles_.at(i, j), &n_);
    }
    return true;
  }

  const int n_;
  Tiles tiles_;
  std::vector<std::vector<int>> below_;
  std::vector<std::atomic<bool>> done_;
  std::atomic<bool> failed_ = false;
};

}  // namespace

bool FactorCholesky(int n, double* A, int num_threads) {
  if (n > kMinTiled) return FactorizationByTiles(n, A).Run(num_threads);
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

void SolveLower(int n, const double* L, int columns, double* B, int first_row) {
  SolveTriangular("N", n, first_row, L, columns, B);
}

void SolveLowerTransposed(int n, const double* L, double* b) {
  SolveTriangular("T", n, 0, L, 1, b);
}

// In blocks that fit into the cache; each thread mirrors a row of blocks.
void MirrorTriangle(Triangle from, size_t n, double* A, int num_threads) {
  constexpr size_t kBlock = 16;
  ParallelFor(static_cast<int>((n + kBlock - 1) / kBlock), num_threads, [&](int row) {
    const size_t k0 = row * kBlock;
    for (size_t l0 = 0; l0 <= k0; l0 += kBlock) {
      for (size_t k = k0; k < std::min(n, k0 + kBlock); ++k) {
        for (size_t l = l0; l < std::min(k, l0 + kBlock); ++l) {
          const size_t lower = k * n + l;
          const size_t upper = l * n + k;
          A[from == Triangle::kUpper ? lower : upper] = A[from == Triangle::kUpper ? upper : lower];
        }
      }
    }
  });
}

std::vector<double> SymmetricEigenvalues(int n, std::vector<double> A) {
  std::vector<double> values(n);
  if (n == 0) return values;
  const BlasCall call;
  int info = 0, size = -1;
  double best_size = 0;
  dsyev_("N", "L", &n, A.data(), &n, values.data(), &best_size, &size, &info);
  size = std::max(3 * n, static_cast<int>(best_size));
  std::vector<double> work(size);
  dsyev_("N", "L", &n, A.data(), &n, values.data(), work.data(), &size, &info);
  if (info != 0) {
    throw Error(ErrorKind::kData, "the eigenvalues of a matrix did not converge")
        .About("eigenvalues");
  }
  return values;
}

}  // namespace trilobe
