#include "io/formats/databases/bilinear_warp.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/linear_density.h"

namespace trilobe {
namespace {

double Lerp(double t, double a, double b) { return (1 - t) * a + t * b; }

// Interval of `value` in running integrals at the nodes 0 .. count-1: the last that begins at or
// below it.
template <typename Integral>
int FindInterval(int count, double value, const Integral& integral) {
  int begin = 0, end = count - 1;
  while (end - begin > 1) {
    const int middle = (begin + end) / 2;
    (integral(middle) <= value ? begin : end) = middle;
  }
  return begin;
}

}  // namespace

NodeInterval LocateNode(double x, int nodes) {
  const double position = x > 0 ? std::min(x, 1.0) * (nodes - 1) : 0.0;  // 0 for NaN, too
  const int index = std::min(static_cast<int>(position), nodes - 2);
  return {index, position - index};
}

BilinearStack BilinearStack::Chosen(int all, const std::vector<size_t>& of_each) const {
  BilinearStack chosen = {rows, columns, {}};
  const std::ptrdiff_t nodes = static_cast<std::ptrdiff_t>(rows) * columns;
  for (std::ptrdiff_t first = 0; first < slices(); first += all) {
    for (const size_t k : of_each) {
      const auto begin = values.begin() + (first + static_cast<std::ptrdiff_t>(k)) * nodes;
      chosen.values.insert(chosen.values.end(), begin, begin + nodes);
    }
  }
  return chosen;
}

double BilinearStack::At(int slice, const SquarePoint& point) const {
  const auto [row, v] = LocateNode(point.y, rows);
  const auto [column, u] = LocateNode(point.x, columns);
  const double* value = &values[(slice * rows + row) * columns + column];
  return Lerp(v, Lerp(u, value[0], value[1]), Lerp(u, value[columns], value[columns + 1]));
}

int BilinearWarp::FirstVanishing(const BilinearStack& density) {
  const int size = density.rows * density.columns;
  for (int slice = 0; slice < density.slices(); ++slice) {
    const auto begin = density.values.begin() + slice * size;
    if (std::all_of(begin, begin + size, [](double p) { return p == 0; })) return slice;
  }
  return -1;
}

// Integrals are in units of cells, by the trapezoidal rule, exact for piecewise linear functions.
BilinearWarp::BilinearWarp(BilinearStack density)
    : density_(std::move(density)),
      row_integral_(density_.values.size()),
      marginal_(density_.slices() * density_.rows) {
  const int rows = density_.rows, columns = density_.columns;
  for (int slice = 0; slice < density_.slices(); ++slice) {
    double* p = &density_.values[slice * rows * columns];
    double* integral = &row_integral_[slice * rows * columns];
    double* marginal = &marginal_[slice * rows];
    for (int r = 0; r < rows; ++r) {
      for (int c = 1; c < columns; ++c) {
        const int node = r * columns + c;
        integral[node] = integral[node - 1] + 0.5 * (p[node - 1] + p[node]);
      }
      if (r == 0) continue;
      const int last = r * columns + columns - 1;
      marginal[r] = marginal[r - 1] + 0.5 * (integral[last - columns] + integral[last]);
    }
    const double total = marginal[rows - 1];
    for (int node = 0; node < rows * columns; ++node) {
      p[node] /= total;
      integral[node] /= total;
    }
    for (int r = 0; r < rows; ++r) marginal[r] /= total;
  }
}

SquarePoint BilinearWarp::Invert(const SliceBlend& blend, const SquarePoint& point) const {
  const int rows = density_.rows, columns = density_.columns;
  const auto [row, v] = LocateNode(point.y, rows);
  const auto [column, u] = LocateNode(point.x, columns);
  // The blend of slices, with `part` the integral along row `point.y` up to `point.x`, and `total`
  // that to its end at the rows below and above.
  double part = 0, below = 0, total_row = 0, total_next = 0;
  for (int k = 0; k < blend.count; ++k) {
    const int slice = blend.slice[k];
    const double weight = blend.weight[k];
    const int begin = (slice * rows + row) * columns;
    const double* p = &density_.values[begin + column];
    const double* integral = &row_integral_[begin + column];
    part += weight * (Lerp(v, integral[0], integral[columns]) +
                      LinearIntegral(u, Lerp(v, p[0], p[columns]), Lerp(v, p[1], p[columns + 1])));
    total_row += weight * row_integral_[begin + columns - 1];
    total_next += weight * row_integral_[begin + 2 * columns - 1];
    below += weight * marginal_[slice * rows + row];
  }
  const double total = Lerp(v, total_row, total_next);
  const double x = total > 0 ? part / total : point.x;
  const double y = below + LinearIntegral(v, total_row, total_next);
  return {std::clamp(x, 0.0, 1.0), std::clamp(y, 0.0, 1.0)};
}

SquarePoint BilinearWarp::Sample(int slice, const SquarePoint& uniform) const {
  const int rows = density_.rows, columns = density_.columns;
  const double* marginal = &marginal_[slice * rows];
  const int row = FindInterval(rows, uniform.y, [&](int r) { return marginal[r]; });
  const double* integral = &row_integral_[(slice * rows + row) * columns];
  const double* p = &density_.values[(slice * rows + row) * columns];
  const double v = InvertLinearIntegral(uniform.y - marginal[row], integral[columns - 1],
                                        integral[2 * columns - 1]);
  const auto along_row = [&](int c) { return Lerp(v, integral[c], integral[c + columns]); };
  const double part = uniform.x * along_row(columns - 1);
  const int column = FindInterval(columns, part, along_row);
  const double u =
      InvertLinearIntegral(part - along_row(column), Lerp(v, p[column], p[column + columns]),
                           Lerp(v, p[column + 1], p[column + columns + 1]));
  return {(column + u) / (columns - 1), (row + v) / (rows - 1)};
}

}  // namespace trilobe
