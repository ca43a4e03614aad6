#ifndef TRILOBE_SOLVERS_SUMS_ROW_ACCUMULATOR_H_
#define TRILOBE_SOLVERS_SUMS_ROW_ACCUMULATOR_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "solvers/sums/kernels.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// Layout of the sums of JointRows. The parameters "of theta_h" are those that all rows of one
// theta_h share: d and s, numbered as in a model, then one of each table of D; those "of theta_d"
// one of each table of F. Those that serve some channel in common with a table of G have a line in
// its sums; one more line of theta_h has the gradient of G.
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

  // Numbers of the parameters.
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

// Doubles from the start of a cache line, which no vector of them straddles then.
class AlignedSums {
 public:
  explicit AlignedSums(size_t size) : lines_((size + 7) / 8) {}
  void Clear() { std::ranges::fill(lines_, CacheLine()); }
  double* data() { return lines_.empty() ? nullptr : lines_[0].values; }
  size_t size() const { return 8 * lines_.size(); }

 private:
  struct alignas(64) CacheLine {
    double values[8] = {};
  };
  std::vector<CacheLine> lines_;
};

// Sums over a share of the rows, and the data of the current row.
struct RowAccumulator {
  RowAccumulator(const RowLayout& layout, int theta_d);

  void Clear();
  double* ThetaDSums(const RowLayout& layout, int d) {
    return theta_d_sums.data() + static_cast<size_t>(d) * kChannels * layout.sums_size;
  }
  double* ThetaDG(const RowLayout& layout, int d) {
    return theta_d_G.data() + d * layout.theta_d_size;
  }

  double objective = 0;
  // Sums over all rows for d and s, over those of the present theta_h for D.
  std::vector<double> theta_h_H;         // [of theta_h][of theta_h], from the diagonal
  std::vector<double> theta_h_gradient;  // [of theta_h]
  // Sums of AddRowSums: over the rows of the present theta_h, with f the factors F; and over those
  // of each theta_d, with g the factors D.
  std::vector<double> theta_h_sums;  // [kChannels][sums_size]
  std::vector<double> D_F;           // H of the present theta_h. [theta_d][of theta_h][of theta_d]
  std::vector<double> theta_d_sums;  // [theta_d][kChannels][sums_size]
  AlignedSums theta_h_G;             // by table: [padded_nodes][theta_h lines]
  AlignedSums theta_d_G;             // [theta_d], by table: [padded_nodes][theta_d lines]

  // Data of one row, padded to whole batches.
  int size = 0, padded_size = 0;
  const int16_t *interval_i = nullptr, *interval_o = nullptr;
  std::array<LobesOfRow, kChannels> lobes;
  std::vector<double> B_i, B_o;                              // [line_size][4]
  std::vector<std::vector<double>> K, H_i, H_o;              // [tables][line_size]
  std::array<std::vector<double>, kChannels> w, w_residual;  // 0 beyond the row
  std::vector<double> phi_lines;                             // [basis][line_size]
  AlignedSums phi;                                           // [line_size][basis]
  std::vector<double> q_lines;                               // [lines][line_size]
  AlignedSums q;                                             // [line_size][lines]
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SUMS_ROW_ACCUMULATOR_H_
