#include "solvers/sums/kernels.h"

#include <cstddef>
#include <cstring>

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
void AddTo(size_t size, const double* __restrict x, double* __restrict sum) {
  for (size_t n = 0; n < size; ++n) sum[n] += x[n];
}

TRILOBE_MULTIVERSION
void SplineWeights(int size, const std::array<OfNodes<4>, 3>& columns, int last_interval,
                   const int16_t* interval, const double* v, double* __restrict B) {
  for (int n = 0; n < size; ++n) {
    const OfNodes<4>& terms = columns[interval[n] == 0 ? 0 : interval[n] == last_interval ? 2 : 1];
    const double t = 0.5 + v[n], u = 0.5 - v[n];
    const Lanes4 weights = u * u * u * terms.term[0] + u * u * t * terms.term[1] +
                           u * t * t * terms.term[2] + t * t * t * terms.term[3];
    std::memcpy(B + 4 * n, &weights, sizeof(weights));
  }
}

TRILOBE_MULTIVERSION
void ReadTable(int size, const CatmullRom::Piece* G, const int16_t* interval_i,
               const int16_t* interval_o, const double* t_i, const double* t_o,
               const double* inverse_cosines, double* __restrict K, double* __restrict H_i,
               double* __restrict H_o) {
  for (int n = 0; n < size; ++n) {
    const double G_i = G[interval_i[n]](t_i[n]), G_o = G[interval_o[n]](t_o[n]);
    K[n] = G_i * G_o * inverse_cosines[n];
    H_i[n] = G_o * inverse_cosines[n];
    H_o[n] = G_i * inverse_cosines[n];
  }
}

namespace {

template <typename Eight>
TRILOBE_ALWAYS_INLINE double WeighResidualsBy(int size, double d, int lobes, const LobesOfRow& lobe,
                                              const double* __restrict w,
                                              const double* __restrict rho,
                                              double* __restrict w_residual) {
  for (int n = 0; n < size; ++n) w_residual[n] = d - rho[n];
  for (int m = 0; m < lobes; ++m) {
    const double x = lobe[m].x;
    const double* __restrict const K = lobe[m].K;
    for (int n = 0; n < size; ++n) w_residual[n] += x * K[n];
  }
  // In the same eight lanes whatever the width of vectors.
  const int whole = size - size % kBatch;
  Eight sums = {};
  for (int n = 0; n < whole; n += kBatch) {
    Eight w_n, residual;
    LoadLanes(w + n, &w_n);
    LoadLanes(w_residual + n, &residual);
    w_n *= residual;
    StoreLanes(w_n, w_residual + n);
    sums += w_n * residual;
  }
  double sum = 0;
  for (int n = whole; n < size; ++n) {
    const double residual = w_residual[n];
    w_residual[n] *= w[n];
    sum += w_residual[n] * residual;
  }
  for (int lane = 0; lane < kBatch; ++lane) sum += sums[lane];
  return sum;
}

}  // namespace

double WeighResiduals(int size, double d, int lobes, const LobesOfRow& lobe, const double* w,
                      const double* rho, double* w_residual) {
  TRILOBE_FOR_EIGHT(WeighResidualsBy, size, d, lobes, lobe, w, rho, w_residual);
}

TRILOBE_MULTIVERSION
void AddRowSums(int size, int basis, const double* w, const double* w_residual, const double* phi,
                const double* f, const double* g, double* sums, double* theta_h_sums,
                double* theta_d_sums) {
  constexpr int kRows = 4;  // of A at a time
  const auto add = [&](int a, int e, const Lanes4& sum) {
    const double f_a = a < basis ? f[a] : 1, g_a = a < basis ? g[a] : 1;
    const int at = a * basis + e;
    Lanes4 f_e, g_e, old;
    std::memcpy(&f_e, f + e, sizeof(f_e));
    std::memcpy(&g_e, g + e, sizeof(g_e));
    std::memcpy(sums + at, &sum, sizeof(sum));
    std::memcpy(&old, theta_h_sums + at, sizeof(old));
    old += f_a * f_e * sum;
    std::memcpy(theta_h_sums + at, &old, sizeof(old));
    std::memcpy(&old, theta_d_sums + at, sizeof(old));
    old += g_a * g_e * sum;
    std::memcpy(theta_d_sums + at, &old, sizeof(old));
  };
  for (int e = 0; e < basis; e += 4) {
    for (int a = 0; a < basis; a += kRows) {
      Lanes4 A[kRows] = {}, b = {};
      for (int n = 0; n < size; ++n) {
        Lanes4 phi_e;
        std::memcpy(&phi_e, phi + n * basis + e, sizeof(phi_e));
        const double* const phi_a = phi + n * basis + a;
        const Lanes4 w_phi_e = w[n] * phi_e;
        for (int k = 0; k < kRows; ++k) A[k] += phi_a[k] * w_phi_e;
        b += w_residual[n] * phi_e;
      }
      for (int k = 0; k < kRows; ++k) add(a + k, e, A[k]);
      if (a == 0) add(basis, e, b);
    }
  }
}

namespace {

template <typename Eight>
TRILOBE_ALWAYS_INLINE void AddChannelBy(int size, double X, const double* __restrict w,
                                        const double* __restrict w_residual, int lobes,
                                        const LobesOfRow& lobe, bool curvature, int d_line,
                                        int gradient_line, int line_size, double* __restrict q) {
  for (int n = 0; n < size; n += kBatch) {
    const auto add = [&](int line, const Eight& value) __attribute__((always_inline)) {
      double* const target = q + static_cast<size_t>(line) * line_size + n;
      Eight sum;
      LoadLanes(target, &sum);
      sum += value;
      StoreLanes(sum, target);
    };
    Eight X_w, residual, u;
    LoadLanes(w + n, &X_w);
    LoadLanes(w_residual + n, &residual);
    X_w *= X;
    add(d_line, X_w);
    add(gradient_line, X * residual);
    for (int m = 0; m < lobes; ++m) {
      LoadLanes(lobe[m].K + n, &u);
      u *= X_w;
      if (curvature && lobe[m].served) u += residual;
      add(lobe[m].s_line, lobe[m].DF * u);
      add(lobe[m].D_line, lobe[m].sF * u);
      add(lobe[m].F_line, lobe[m].sD * u);
    }
  }
}

}  // namespace

void AddChannel(int size, double X, const double* w, const double* w_residual, int lobes,
                const LobesOfRow& lobe, bool curvature, int d_line, int gradient_line,
                int line_size, double* q) {
  TRILOBE_FOR_EIGHT(AddChannelBy, size, X, w, w_residual, lobes, lobe, curvature, d_line,
                    gradient_line, line_size, q);
}

TRILOBE_MULTIVERSION
void Transpose(int lines, int size, int line_size, const double* __restrict from,
               double* __restrict target) {
  for (int line = 0; line < lines; line += 4) {
    for (int n = 0; n < size; n += 4) {
      const double* const tile = from + static_cast<size_t>(line) * line_size + n;
      Lanes4 a, b, c, d;
      std::memcpy(&a, tile, sizeof(a));
      std::memcpy(&b, tile + line_size, sizeof(b));
      std::memcpy(&c, tile + 2 * line_size, sizeof(c));
      std::memcpy(&d, tile + 3 * line_size, sizeof(d));
      const Lanes4 ab_02 = __builtin_shufflevector(a, b, 0, 4, 2, 6);
      const Lanes4 ab_13 = __builtin_shufflevector(a, b, 1, 5, 3, 7);
      const Lanes4 cd_02 = __builtin_shufflevector(c, d, 0, 4, 2, 6);
      const Lanes4 cd_13 = __builtin_shufflevector(c, d, 1, 5, 3, 7);
      const Lanes4 columns[] = {__builtin_shufflevector(ab_02, cd_02, 0, 1, 4, 5),
                                __builtin_shufflevector(ab_13, cd_13, 0, 1, 4, 5),
                                __builtin_shufflevector(ab_02, cd_02, 2, 3, 6, 7),
                                __builtin_shufflevector(ab_13, cd_13, 2, 3, 6, 7)};
      for (int k = 0; k < 4; ++k) {
        std::memcpy(target + static_cast<size_t>(n + k) * lines + line, &columns[k],
                    sizeof(Lanes4));
      }
    }
  }
}

namespace {

// sums [node][lines] += z q for the four nodes of one side of each sample: one vector of lines.
// Along a row theta_i and theta_o move slowly. So the sums of four nodes stay in registers until a
// sample reads others, where each would wait for the one before to come back from memory.
template <typename Lanes>
TRILOBE_ALWAYS_INLINE void AddSide(int size, const int16_t* interval, const double* B,
                                   const double* H, int q_lines, const double* q, int lines,
                                   double* sums) {
  Lanes sum[4];
  double* nodes = sums + static_cast<size_t>(interval[0]) * lines;
  const auto load = [&]() __attribute__((always_inline)) {
    for (int a = 0; a < 4; ++a) LoadLanes(nodes + a * lines, &sum[a]);
  };
  const auto store = [&]() __attribute__((always_inline)) {
    for (int a = 0; a < 4; ++a) StoreLanes(sum[a], nodes + a * lines);
  };
  load();
  for (int n = 0; n < size; ++n, q += q_lines, B += 4) {
    if (n > 0 && interval[n] != interval[n - 1]) {
      store();
      nodes = sums + static_cast<size_t>(interval[n]) * lines;
      load();
    }
    Lanes H_q;
    LoadLanes(q, &H_q);
    H_q *= H[n];
    for (int a = 0; a < 4; ++a) sum[a] += B[a] * H_q;
  }
  store();
}

// The same of both sides.
template <typename Lanes>
TRILOBE_ALWAYS_INLINE void AddSides(const RowOfNodes& row, int q_lines, const double* q, int lines,
                                    double* sums) {
  AddSide<Lanes>(row.size, row.interval_i, row.B_i, row.H_i, q_lines, q, lines, sums);
  AddSide<Lanes>(row.size, row.interval_o, row.B_o, row.H_o, q_lines, q, lines, sums);
}

template <typename Eight>
TRILOBE_ALWAYS_INLINE void AddCrossSumsBy(const RowOfNodes& row, int theta_h_lines,
                                          int theta_d_lines, const double* q, double* theta_h_sums,
                                          double* theta_d_sums) {
  const int lines = theta_h_lines + theta_d_lines;
  for (int line = 0; line < theta_h_lines; line += 8) {
    AddSides<Eight>(row, lines, q + line, theta_h_lines, theta_h_sums + line);
  }
  for (int line = 0; line < theta_d_lines; line += 4) {
    AddSides<Lanes4>(row, lines, q + theta_h_lines + line, theta_d_lines, theta_d_sums + line);
  }
}

}  // namespace

void AddCrossSums(const RowOfNodes& row, int theta_h_lines, int theta_d_lines, const double* q,
                  double* theta_h_sums, double* theta_d_sums) {
  TRILOBE_FOR_EIGHT(AddCrossSumsBy, row, theta_h_lines, theta_d_lines, q, theta_h_sums,
                    theta_d_sums);
}

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
