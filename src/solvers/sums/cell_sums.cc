#include "solvers/sums/cell_sums.h"

#include <array>
#include <cstring>
#include <numeric>
#include <utility>
#include <vector>

#include "core/algebra/element_step.h"
#include "core/algebra/nonnegative_least_squares.h"
#include "core/base/multiversion.h"
#include "model/objective/shadowing_pieces.h"
#include "solvers/sums/kernels.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

constexpr int kMaxBasis = 1 + kMaxLobes;
static_assert(kMaxBasis <= kMaxNonnegativeUnknowns);

// b_a = sum w residual phi_a and A_ae = sum w phi_a phi_e over the samples of a row. The rows of A
// are `stride` apart.
template <typename Eight>
TRILOBE_ALWAYS_INLINE void RowSumsBy(int size, const double* __restrict w,
                                     const double* __restrict residual, const double* const* phi,
                                     int basis, int stride, double* __restrict b,
                                     double* __restrict A) {
  constexpr int kLanes = 8;
  const int whole = size - size % kLanes;
  const auto dot = [&](const double* x, const double* y) __attribute__((always_inline)) {
    Eight sums = {}, w_n, x_n, y_n;
    for (int n = 0; n < whole; n += kLanes) {
      LoadLanes(w + n, &w_n);
      LoadLanes(x + n, &x_n);
      LoadLanes(y + n, &y_n);
      sums += w_n * x_n * y_n;
    }
    double sum = 0;
    for (int n = whole; n < size; ++n) sum += w[n] * x[n] * y[n];
    for (int lane = 0; lane < kLanes; ++lane) sum += sums[lane];
    return sum;
  };
  for (int a = 0; a < basis; ++a) {
    b[a] = dot(phi[a], residual);
    for (int e = a; e < basis; ++e) A[a * stride + e] = A[e * stride + a] = dot(phi[a], phi[e]);
  }
}
void RowSums(int size, const double* w, const double* residual, const double* const* phi, int basis,
             int stride, double* b, double* A) {
  TRILOBE_FOR_EIGHT(RowSumsBy, size, w, residual, phi, basis, stride, b, A);
}

// residual -= x K
TRILOBE_MULTIVERSION
void SubtractScaled(int size, double x, const double* __restrict K, double* __restrict residual) {
  for (int n = 0; n < size; ++n) residual[n] -= x * K[n];
}

// The sparse direction v in which an element moves a cell's x.
struct MovedLobes {
  int count = 0;
  std::array<int, kMaxLobes> basis;
  std::array<double, kMaxLobes> v;
  void Add(int a, double value) {
    basis[count] = a;
    v[count++] = value;
  }
};

}  // namespace

CellSums::CellSums(const FoldedGrid& folded, const ModelSpec& spec)
    : folded_(folded),
      spec_(spec),
      basis_(1 + spec.lobes),
      padded_(PaddedBasis(basis_)),
      numbers_(static_cast<size_t>(folded.num_rows()) * kChannels * stride()) {}

void CellSums::Accumulate(const FactorModel& model, int num_threads) {
  const auto G = ShadowingPieces(model);
  const int max_row = folded_.max_row_size();
  ParallelFor(folded_.grid.theta_h, num_threads, [&](int h) {
    const std::vector<double> ones(max_row, 1.0);
    std::vector<double> K(G.size() * max_row), residual(max_row);
    std::array<const double*, kMaxBasis> phi{ones.data()};
    for (int d = 0; d < folded_.grid.theta_d; ++d) {
      const int row = h * folded_.grid.theta_d + d;
      const int begin = folded_.row_begin[row], end = folded_.row_begin[row + 1];
      const int size = end - begin;
      for (size_t t = 0; t < G.size(); ++t) {
        EvaluateShadowing(folded_, G[t], begin, end, K.data() + t * max_row);
      }
      for (int c = 0; c < kChannels; ++c) {
        const double* const rho = folded_.rho[c].data() + begin;
        for (int n = 0; n < size; ++n) residual[n] = rho[n] - model.d()[c];
        for (int m = 0; m < spec_.lobes; ++m) {
          const double* const Km = phi[1 + m] = K.data() + spec_.table(Factor::kG, m, c) * max_row;
          const double x = model.s(m)[c] * model.D(m, c)[h] * model.F(m, c)[d];
          SubtractScaled(size, x, Km, residual.data());
        }
        RowSums(size, folded_.weight[c].data() + begin, residual.data(), phi.data(), basis_,
                padded_, mutable_b(h, d, c), mutable_b(h, d, c) + padded_);
      }
    }
  });
}

template <typename Moved>
void CellSums::Update(const Block& block, const Moved& moved, double* element) {
  const auto for_each_cell = [&](const auto& visit) {
    for (int h = block.h.begin; h < block.h.end; ++h) {
      for (int d = block.d.begin; d < block.d.end; ++d) {
        for (int c = block.channels.begin; c < block.channels.end; ++c) visit(h, d, c);
      }
    }
  };
  double g = 0, H = 0;
  for_each_cell([&](int h, int d, int c) {
    const MovedLobes v = moved(h, d, c);
    const double* const b_hdc = b(h, d, c);
    const double* const A_hdc = A(h, d, c);
    for (int k = 0; k < v.count; ++k) {
      g += v.v[k] * b_hdc[v.basis[k]];
      for (int l = 0; l < v.count; ++l) {
        H += v.v[k] * v.v[l] * A_hdc[v.basis[k] * padded_ + v.basis[l]];
      }
    }
  });
  double delta = 0;
  if (!MoveToMinimum({&H, 1}, {&g, 1}, /*E=*/0, {&element, 1}, &delta)) return;
  for_each_cell([&](int h, int d, int c) {
    const MovedLobes v = moved(h, d, c);
    double* const b_hdc = mutable_b(h, d, c);
    const double* const A_hdc = A(h, d, c);
    for (int k = 0; k < v.count; ++k) {
      const double step = delta * v.v[k];
      for (int a = 0; a < basis_; ++a) b_hdc[a] -= step * A_hdc[v.basis[k] * padded_ + a];
    }
  });
}

void CellSums::UpdateBlock(const MovedCells& cells, std::span<const int> element_of,
                           std::span<double* const> elements, double E) const {
  std::array<double, kMaxCellBasis> along{}, steps{};
  std::array<double, kMaxCellBasis * kMaxCellBasis> products{};
  AddAlong(cells, padded_, along.data(), products.data());
  const size_t count = elements.size();
  std::array<double, kMaxBasis> g{}, delta{};
  std::array<double, kMaxBasis * kMaxBasis> H{};
  for (int a = 0; a < basis_; ++a) {
    if (element_of[a] < 0) continue;
    g[element_of[a]] += along[a];
    for (int e = 0; e < basis_; ++e) {
      if (element_of[e] < 0) continue;
      H[element_of[a] * count + element_of[e]] += products[a * padded_ + e];
    }
  }
  if (!MoveToMinimum({H.data(), count * count}, {g.data(), count}, E, elements, delta.data())) {
    return;
  }
  for (int a = 0; a < basis_; ++a) steps[a] = element_of[a] < 0 ? 0 : delta[element_of[a]];
  MoveAlong(cells, padded_, steps.data());
}

void CellSums::UpdateAll(const std::function<void(const FactorModel&)>& on_element,
                         FactorModel* model) {
  const Range all_h{0, folded_.grid.theta_h}, all_d{0, folded_.grid.theta_d};
  const auto update = [&](const Block& block, const auto& moved, double* element) {
    Update(block, moved, element);
    if (on_element) on_element(*model);
  };

  for (int c = 0; c < kChannels; ++c) {
    const auto moved = [](int, int, int) {
      MovedLobes v;
      v.Add(0, 1);
      return v;
    };
    update({all_h, all_d, {c, c + 1}}, moved, &model->d()[c]);
  }
  for (int m = 0; m < spec_.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      const auto D = std::as_const(*model).D(m, c), F = std::as_const(*model).F(m, c);
      const auto moved = [&](int h, int d, int) {
        MovedLobes v;
        v.Add(1 + m, D[h] * F[d]);
        return v;
      };
      update({all_h, all_d, {c, c + 1}}, moved, &model->s(m)[c]);
    }
  }
  for (const Factor factor : {Factor::kD, Factor::kF}) {
    const bool is_D = factor == Factor::kD;
    for (int t = 0; t < spec_.num_tables(factor); ++t) {
      const auto moved = [&](int h, int d, int c) {
        MovedLobes v;
        for (int m = 0; m < spec_.lobes; ++m) {
          if (!spec_.serves(factor, t, m, c)) continue;
          const FactorModel& now = *model;
          v.Add(1 + m, now.s(m)[c] * (is_D ? now.F(m, c)[d] : now.D(m, c)[h]));
        }
        return v;
      };
      const auto [begin, end] = spec_.channels(factor, t);
      const Range channels{begin, end};
      for (int k = 0; k < spec_.table_size(factor); ++k) {
        const Range only{k, k + 1};
        update({is_D ? only : all_h, is_D ? all_d : only, channels}, moved,
               &model->table(factor, t)[k]);
      }
    }
  }
}

void CellSums::UpdateBlocks(double E, int num_threads,
                            const std::function<void(const FactorModel&)>& on_block,
                            FactorModel* model) {
  const int thetas_h = folded_.grid.theta_h, thetas_d = folded_.grid.theta_d, lobes = spec_.lobes;
  if (on_block) num_threads = 1;  // it sees the blocks in order
  // Blocks of one kind move different cells.
  const auto for_each_block = [&](int count, const auto& update) {
    ParallelFor(count, num_threads, [&](int k) {
      update(k);
      if (on_block) on_block(*model);
    });
  };
  const size_t cell = stride(), row = kChannels * cell, rows = thetas_d * row;
  const auto numbers = [this](int h, int d, int c) { return mutable_b(h, d, c); };
  const FactorModel& now = *model;

  for_each_block(kChannels, [&](int c) {
    std::array<double*, kMaxBasis> elements{&model->d()[c]};
    std::array<int, kMaxBasis> element_of{};
    for (int m = 0; m < lobes; ++m) elements[1 + m] = &model->s(m)[c];
    std::iota(element_of.begin(), element_of.end(), 0);
    std::vector<double> v(static_cast<size_t>(thetas_h) * thetas_d * padded_);
    double* at = v.data();
    for (int h = 0; h < thetas_h; ++h) {
      for (int d = 0; d < thetas_d; ++d, at += padded_) {
        at[0] = 1;
        for (int m = 0; m < lobes; ++m) at[1 + m] = now.D(m, c)[h] * now.F(m, c)[d];
      }
    }
    const size_t steps = padded_;
    UpdateBlock(
        {{numbers(0, 0, c), thetas_h, thetas_d, rows, row}, {v.data(), steps * thetas_d, steps}},
        element_of, {elements.data(), static_cast<size_t>(basis_)}, E);
  });
  for (const Factor factor : {Factor::kD, Factor::kF}) {
    const bool is_D = factor == Factor::kD;
    const TableSharing& sharing = spec_.sharing(factor);
    const int groups = sharing.per_channel ? kChannels : 1;
    const int tables = spec_.num_tables(factor) / groups;  // that channels of a group read
    if (tables == 0) continue;
    std::array<int, kMaxBasis> element_of{-1};
    for (int m = 0; m < lobes; ++m) element_of[1 + m] = sharing.per_lobe ? m : 0;
    // Derivative of x by an entry: s times the other factor, [its entries][kChannels][padded_].
    const int others = is_D ? thetas_d : thetas_h;
    const size_t step = padded_, steps = kChannels * step;
    std::vector<double> v(others * steps);
    for (int k = 0; k < others; ++k) {
      for (int c = 0; c < kChannels; ++c) {
        for (int m = 0; m < lobes; ++m) {
          v[k * steps + c * step + 1 + m] = now.s(m)[c] * (is_D ? now.F(m, c)[k] : now.D(m, c)[k]);
        }
      }
    }
    for_each_block(spec_.table_size(factor) * groups, [&](int item) {
      const int k = item / groups, first_channel = item % groups;
      std::array<double*, kMaxLobes> elements{};
      for (int t = 0; t < tables; ++t) {
        elements[t] = &model->table(factor, spec_.table(factor, t, first_channel))[k];
      }
      const auto [begin, end] = spec_.channels(factor, spec_.table(factor, 0, first_channel));
      UpdateBlock({{is_D ? numbers(k, 0, begin) : numbers(0, k, begin), others, end - begin,
                    is_D ? row : rows, cell},
                   {&v[begin * step], steps, step}},
                  element_of, {elements.data(), static_cast<size_t>(tables)}, E);
    });
  }
}

}  // namespace trilobe
