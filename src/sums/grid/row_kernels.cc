#include "sums/grid/row_kernels.h"

#include <cstddef>
#include <cstring>

#include "base/multiversion.h"

namespace trilobe {

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

TRILOBE_MULTIVERSION
double WeighResiduals(int size, double d, int lobes, const LobesOfRow& lobe,
                      const double* __restrict w, const double* __restrict rho,
                      double* __restrict w_residual) {
  for (int n = 0; n < size; ++n) w_residual[n] = d - rho[n];
  for (int m = 0; m < lobes; ++m) {
    const double x = lobe[m].x;
    const double* __restrict const K = lobe[m].K;
    for (int n = 0; n < size; ++n) w_residual[n] += x * K[n];
  }
  // In the same eight lanes whatever the width of vectors.
  const int whole = size - size % kBatch;
  Lanes8 sums = {};
  for (int n = 0; n < whole; n += kBatch) {
    Lanes8 w_n, residual;
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

TRILOBE_MULTIVERSION
void AddChannel(int size, double X, const double* __restrict w, const double* __restrict w_residual,
                int lobes, const LobesOfRow& lobe, bool curvature, int d_line, int gradient_line,
                int line_size, double* __restrict q) {
  for (int n = 0; n < size; n += kBatch) {
    const auto load = [n](const double* from, Lanes8* value) {
      std::memcpy(value, from + n, sizeof(*value));
    };
    const auto add = [&](int line, const Lanes8& value) {
      double* const target = q + static_cast<size_t>(line) * line_size;
      Lanes8 sum;
      load(target, &sum);
      sum += value;
      std::memcpy(target + n, &sum, sizeof(sum));
    };
    Lanes8 X_w, residual, u;
    load(w, &X_w);
    load(w_residual, &residual);
    X_w *= X;
    add(d_line, X_w);
    add(gradient_line, X * residual);
    for (int m = 0; m < lobes; ++m) {
      load(lobe[m].K, &u);
      u *= X_w;
      if (curvature && lobe[m].served) u += residual;
      add(lobe[m].s_line, lobe[m].DF * u);
      add(lobe[m].D_line, lobe[m].sF * u);
      add(lobe[m].F_line, lobe[m].sD * u);
    }
  }
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

// sums [node][lines] += z q for the four nodes of both sides of each sample: one vector of lines.
template <typename Lanes>
[[gnu::always_inline]] inline void AddLanes(const RowOfNodes& row, int q_lines, const double* q,
                                            int lines, double* sums) {
  const auto add = [lines](const double* B, const Lanes& H_q, double* at) {
    for (int a = 0; a < 4; ++a, at += lines) {
      Lanes sum;
      std::memcpy(&sum, at, sizeof(Lanes));
      sum += B[a] * H_q;
      std::memcpy(at, &sum, sizeof(Lanes));
    }
  };
  const RowOfNodes nodes = row;  // nothing below can change it
  for (int n = 0; n < nodes.size; ++n, q += q_lines) {
    Lanes q_n;
    std::memcpy(&q_n, q, sizeof(Lanes));
    add(nodes.B_i + 4 * n, nodes.H_i[n] * q_n,
        sums + static_cast<size_t>(nodes.interval_i[n]) * lines);
    add(nodes.B_o + 4 * n, nodes.H_o[n] * q_n,
        sums + static_cast<size_t>(nodes.interval_o[n]) * lines);
  }
}

}  // namespace

TRILOBE_MULTIVERSION
void AddCrossSums(const RowOfNodes& row, int theta_h_lines, int theta_d_lines, const double* q,
                  double* theta_h_sums, double* theta_d_sums) {
  const int lines = theta_h_lines + theta_d_lines;
  for (int line = 0; line < theta_h_lines; line += 8) {
    AddLanes<Lanes8>(row, lines, q + line, theta_h_lines, theta_h_sums + line);
  }
  for (int line = 0; line < theta_d_lines; line += 4) {
    AddLanes<Lanes4>(row, lines, q + theta_h_lines + line, theta_d_lines, theta_d_sums + line);
  }
}

}  // namespace trilobe
