#include "solvers/sums/grid/cell_kernels.h"

#include "core/base/multiversion.h"

namespace trilobe {
namespace {

template <typename Visit>
TRILOBE_ALWAYS_INLINE void ForEachCell(const MovedCells& moved, const Visit& visit) {
  const auto& [cells, v] = moved;
  for (int o = 0; o < cells.outer; ++o) {
    for (int i = 0; i < cells.inner; ++i) {
      visit(cells.first + o * cells.outer_stride + i * cells.inner_stride,
            v.first + o * v.outer_stride + i * v.inner_stride);
    }
  }
}

template <int kVectors>
TRILOBE_ALWAYS_INLINE void AddAlongBy(const MovedCells& moved, double* g, double* H) {
  constexpr int kBasis = 4 * kVectors;
  Lanes4 along[kVectors] = {}, products[kBasis][kVectors] = {};
  ForEachCell(
      moved, [&](const double* b, const double* v) __attribute__((always_inline)) {
        const double* const A = b + kBasis;
        for (int k = 0; k < kVectors; ++k) {
          Lanes4 v_k, b_k;
          LoadLanes(v + 4 * k, &v_k);
          LoadLanes(b + 4 * k, &b_k);
          along[k] += v_k * b_k;
          for (int a = 0; a < kBasis; ++a) {
            Lanes4 A_a;
            LoadLanes(A + a * kBasis + 4 * k, &A_a);
            products[a][k] += v[a] * v_k * A_a;
          }
        }
      });
  for (int k = 0; k < kVectors; ++k) {
    for (int e = 0; e < 4; ++e) {
      g[4 * k + e] += along[k][e];
      for (int a = 0; a < kBasis; ++a) H[a * kBasis + 4 * k + e] += products[a][k][e];
    }
  }
}

template <int kVectors>
TRILOBE_ALWAYS_INLINE void MoveAlongBy(const MovedCells& moved, const double* steps) {
  constexpr int kBasis = 4 * kVectors;
  ForEachCell(
      moved, [&](double* b, const double* v) __attribute__((always_inline)) {
        const double* const A = b + kBasis;
        for (int k = 0; k < kVectors; ++k) {
          Lanes4 b_k, A_a;
          LoadLanes(b + 4 * k, &b_k);
          for (int a = 0; a < kBasis; ++a) {
            LoadLanes(A + a * kBasis + 4 * k, &A_a);
            b_k -= steps[a] * v[a] * A_a;
          }
          StoreLanes(b_k, b + 4 * k);
        }
      });
}

static_assert(kMaxCellBasis <= 12);

}  // namespace

TRILOBE_MULTIVERSION
void AddAlong(const MovedCells& moved, int basis, double* g, double* H) {
  if (basis == 4) return AddAlongBy<1>(moved, g, H);
  if (basis == 8) return AddAlongBy<2>(moved, g, H);
  AddAlongBy<3>(moved, g, H);
}

TRILOBE_MULTIVERSION
void MoveAlong(const MovedCells& moved, int basis, const double* steps) {
  if (basis == 4) return MoveAlongBy<1>(moved, steps);
  if (basis == 8) return MoveAlongBy<2>(moved, steps);
  MoveAlongBy<3>(moved, steps);
}

}  // namespace trilobe
