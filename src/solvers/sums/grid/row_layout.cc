#include "solvers/sums/grid/row_layout.h"

#include <algorithm>

#include "solvers/sums/grid/row_kernels.h"
#include "trilobe/core/math/catmull_rom.h"

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

}  // namespace trilobe
