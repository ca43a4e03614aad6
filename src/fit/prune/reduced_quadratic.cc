#include "fit/prune/reduced_quadratic.h"

#include <cstddef>
#include <utility>

#include "solvers/joint/joint_step.h"
#include "solvers/joint/nonnegative_step.h"

namespace trilobe {

void HoldTableSizes(std::span<const FactorModel::Part> parts, int first_table,
                    std::span<const double> y, std::span<const double> scale, QuadraticModel* at) {
  const size_t n = y.size();
  std::vector<double> u(n);  // scale^2 y
  for (size_t j = 0; j < n; ++j) u[j] = scale[j] * scale[j] * y[j];
  for (const auto [begin, size] : parts.subspan(first_table)) {
    double squares = 0;
    for (int j = begin; j < begin + size; ++j) squares += u[j] * y[j];
    if (!(squares > 0)) continue;
    for (int i = begin; i < begin + size; ++i) {
      for (int j = begin; j < begin + size; ++j) at->H[i * n + j] += u[i] * u[j] / squares;
    }
  }
}

std::vector<double> GradientChange(const QuadraticModel& at, std::span<const double> from,
                                   std::span<const double> target) {
  const size_t n = from.size();
  std::vector<double> change(n, 0.0);
  for (size_t k = 0; k < n; ++k) {
    const double* const row = &at.H[k * n];
    for (size_t l = 0; l < n; ++l) change[k] += row[l] * (target[l] - from[l]);
  }
  return change;
}

ReducedPoint LowestWithin(const Reduction& reduction, const QuadraticModel& at,
                          std::span<const double> x, std::span<const double> y0, int lobes) {
  const std::vector<double> x0 = reduction.Expand(y0);
  const std::vector<double> change = GradientChange(at, x, x0);
  double rise = 0;
  for (size_t k = 0; k < x.size(); ++k) rise += (x0[k] - x[k]) * (2 * at.gradient[k] + change[k]);
  QuadraticModel reduced = reduction(at);
  const std::vector<double> reduced_change = reduction.Transpose(change);
  for (size_t j = 0; j < y0.size(); ++j) reduced.gradient[j] += reduced_change[j];
  const std::vector<double> scale = DampingMetric(reduction.parts(), reduced.squared_lengths);
  HoldTableSizes(reduction.parts(), 1 + lobes, y0, scale, &reduced);
  NonnegativeStep step;
  step.MoveTo(reduced, scale, y0);
  NonnegativeStep::Result result = step.Solve(kQuadraticDamping);
  return {.y = std::move(result.x), .rise = rise - 2 * result.predicted_decrease};
}

}  // namespace trilobe
