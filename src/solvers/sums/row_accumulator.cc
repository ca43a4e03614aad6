#include "solvers/sums/row_accumulator.h"

#include <algorithm>

#include "solvers/sums/kernels.h"
#include "trilobe/core/base/catmull_rom.h"

namespace trilobe {

RowLayout::RowLayout(const ModelSpec& of_model, int max_row)
    : spec(of_model),
      first_D(kChannels * (1 + spec.lobes)),
      num_of_theta_h(first_D + spec.num_tables(Factor::kD)),
      num_of_theta_d(spec.num_tables(Factor::kF)),
      padded_nodes(spec.g_axis.size + 2),
      line_size((max_row + kBatch - 1) / kBatch * kBatch),
      basis((1 + spec.lobes + 3) / 4 * 4),
      sums_size((basis + 1) * basis),
      tables(spec.num_tables(Factor::kG)) {
  const CatmullRom spline(spec.g_axis.size);
  columns = {WeightsOfNodes(spline, 0), WeightsOfNodes(spline, 1),
             WeightsOfNodes(spline, spec.g_axis.size - 2)};
  for (int t = 0; t < static_cast<int>(tables.size()); ++t) {
    OfTable& table = tables[t];
    table.theta_h_line.assign(num_of_theta_h, -1);
    table.theta_d_line.assign(num_of_theta_d, -1);
    const auto [begin, end] = spec.channels(Factor::kG, t);
    for (int c = begin; c < end; ++c) {
      table.theta_h_line[c] = 0;
      for (int m = 0; m < spec.lobes; ++m) {
        table.theta_h_line[s(m, c)] = table.theta_h_line[D(m, c)] = table.theta_d_line[F(m, c)] = 0;
      }
    }
    const auto number = [](std::vector<int>* line_of) {
      int lines = 0;
      for (int& line : *line_of) {
        if (line == 0) line = lines++;
      }
      return lines;
    };
    const auto padded = [](int size, int multiple) {
      return (size + multiple - 1) / multiple * multiple;
    };
    table.gradient_line = number(&table.theta_h_line);
    table.theta_h_lines = padded(table.gradient_line + 1, 8);
    table.theta_d_lines = padded(number(&table.theta_d_line), 4);
    table.theta_h_begin = theta_h_size;
    table.theta_d_begin = theta_d_size;
    theta_h_size += static_cast<size_t>(table.theta_h_lines) * padded_nodes;
    theta_d_size += static_cast<size_t>(table.theta_d_lines) * padded_nodes;
    max_lines = std::max(max_lines, table.lines());
  }
}

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
