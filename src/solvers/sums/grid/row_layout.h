#ifndef TRILOBE_SOLVERS_SUMS_GRID_ROW_LAYOUT_H_
#define TRILOBE_SOLVERS_SUMS_GRID_ROW_LAYOUT_H_

#include <array>
#include <cstddef>
#include <vector>

#include "solvers/sums/grid/node_lanes.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// What lies where in the sums of JointRows. The parameters "of theta_h" are those that all rows of
// one theta_h share: d and s, numbered as in a model, then one of each table of D; those "of
// theta_d" one of each table of F. Those that serve some channel in common with a table of G have a
// line in its sums; one more line of theta_h has the gradient of G.
class RowLayout {
 public:
  struct OfTable {
    std::vector<int> theta_h_line, theta_d_line;  // of each parameter; none: -1
    int gradient_line = 0;
    int theta_h_lines = 0, theta_d_lines = 0;     // padded to whole vectors
    size_t theta_h_begin = 0, theta_d_begin = 0;  // where the sums start
    int lines() const { return theta_h_lines + theta_d_lines; }
  };

  RowLayout(const ModelSpec& of_model, int max_row);

  // Their numbers.
  static int s(int m, int c) { return kChannels * (1 + m) + c; }
  int D(int m, int c) const { return first_D + spec.table(Factor::kD, m, c); }
  int F(int m, int c) const { return spec.table(Factor::kF, m, c); }

  const ModelSpec spec;
  const int first_D, num_of_theta_h, num_of_theta_d, padded_nodes, line_size;
  const int basis, sums_size;  // of AddRowSums
  int max_lines = 0;
  size_t theta_h_size = 0, theta_d_size = 0;  // of the sums of all tables
  std::vector<OfTable> tables;
  std::array<OfNodes<4>, 3> columns;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_GRID_ROW_LAYOUT_H_
