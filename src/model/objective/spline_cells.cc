#include "trilobe/model/objective/spline_cells.h"

#include <algorithm>
#include <numeric>

namespace trilobe {

SplineCells::SplineCells(const FoldedGrid& folded) : grid(folded.grid) {
  // Counting sort.
  const int intervals = folded.g_nodes - 1;
  const auto key = [&](int n) { return folded.interval_i[n] * intervals + folded.interval_o[n]; };
  std::vector<int> begin(static_cast<size_t>(intervals) * intervals + 1, 0);
  for (int n = 0; n < folded.size(); ++n) ++begin[key(n) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (int cell = 0; cell < intervals * intervals; ++cell) {
    if (begin[cell] == begin[cell + 1]) continue;
    cells.push_back({cell / intervals, cell % intervals, begin[cell], begin[cell + 1]});
  }
  std::vector<int> order(folded.size());
  for (int n = 0; n < folded.size(); ++n) order[begin[key(n)]++] = n;

  const auto sorted = [&order]<typename T>(const std::vector<T>& values) {
    std::vector<T> result(values.size());
    std::ranges::transform(order, result.begin(), [&values](int n) { return values[n]; });
    return result;
  };
  t_i = sorted(folded.t_i);
  t_o = sorted(folded.t_o);
  inverse_cosines = sorted(folded.inverse_cosines);
  for (int c = 0; c < kChannels; ++c) {
    weight[c] = sorted(folded.weight[c]);
    rho[c] = sorted(folded.rho[c]);
  }
  std::vector<int> row_of(folded.size());
  for (int r = 0; r < folded.num_rows(); ++r) {
    std::fill(row_of.begin() + folded.row_begin[r], row_of.begin() + folded.row_begin[r + 1], r);
  }
  row = sorted(row_of);
}

std::vector<double> LobeAmplitudes(const MerlGrid& grid, const FactorModel& model) {
  std::vector<double> amplitudes;
  amplitudes.reserve(static_cast<size_t>(kChannels) * model.spec().lobes * grid.theta_h *
                     grid.theta_d);
  for (int c = 0; c < kChannels; ++c) {
    for (int m = 0; m < model.spec().lobes; ++m) {
      for (const double D : model.D(m, c)) {
        for (const double F : model.F(m, c)) amplitudes.push_back(model.s(m)[c] * D * F);
      }
    }
  }
  return amplitudes;
}

}  // namespace trilobe
