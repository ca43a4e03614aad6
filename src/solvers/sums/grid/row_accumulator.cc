#include "solvers/sums/grid/row_accumulator.h"

#include <algorithm>

namespace trilobe {

RowAccumulator::RowAccumulator(const RowLayout& layout, int theta_d)
    : theta_h_H(static_cast<size_t>(layout.num_of_theta_h) * layout.num_of_theta_h),
      theta_h_gradient(layout.num_of_theta_h),
      theta_h_sums(static_cast<size_t>(kChannels) * layout.sums_size),
      D_F(static_cast<size_t>(theta_d) * layout.num_of_theta_h * layout.num_of_theta_d),
      theta_d_sums(theta_d * theta_h_sums.size()),
      theta_h_G(layout.theta_h_size),
      theta_d_G(theta_d * layout.theta_d_size),
      B_i(4 * static_cast<size_t>(layout.line_size)),
      B_o(B_i.size()),
      phi_lines(static_cast<size_t>(layout.basis) * layout.line_size),
      phi(phi_lines.size()),
      q_lines(static_cast<size_t>(layout.max_lines) * layout.line_size),
      q(q_lines.size()) {
  std::fill_n(phi_lines.begin(), layout.line_size, 1.0);
  w_residual.fill(std::vector<double>(layout.line_size));
  w = w_residual;
  for (auto* of_tables : {&K, &H_i, &H_o}) {
    of_tables->assign(layout.tables.size(), std::vector<double>(layout.line_size));
  }
}

void RowAccumulator::Clear() {
  objective = 0;
  for (auto* sums : {&theta_h_H, &theta_h_gradient, &theta_h_sums, &D_F, &theta_d_sums}) {
    std::ranges::fill(*sums, 0.0);
  }
  theta_h_G.Clear();
  theta_d_G.Clear();
}

}  // namespace trilobe
