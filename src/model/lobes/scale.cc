#include "model/lobes/scale.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trilobe {
namespace {

double WithoutRounding(double norm) {
  constexpr double kRounding = 1e-13;
  int exponent = 0;
  const double fraction = std::frexp(norm, &exponent);  // in [1/2, 1)
  if (1 - fraction <= kRounding) return std::ldexp(1.0, exponent);
  if (2 * fraction - 1 <= kRounding) return std::ldexp(1.0, exponent - 1);
  return norm;
}

}  // namespace

bool AnyCovered(std::span<const double> coverage) {
  return std::ranges::any_of(coverage, [](double weight) { return weight > 0; });
}

void Divide(Factor factor, int index, double norm, FactorModel* model) {
  norm = WithoutRounding(norm);
  for (double& x : model->table(factor, index)) x /= norm;
  ForEachServed(model->spec(), factor, index,
                [&](int m, int c) { model->s(m)[c] *= factor == Factor::kG ? norm * norm : norm; });
}

void MoveZeroToS(std::span<const double> coverage, Factor factor, int index, FactorModel* model) {
  const std::span<double> table = model->table(factor, index);
  const int offset = model->TableOffset(factor, index);
  for (size_t k = 0; k < table.size(); ++k) {
    if (coverage[offset + k] > 0 && table[k] > 0) return;
  }
  std::ranges::fill(table, 1.0);
  ForEachServed(model->spec(), factor, index, [&](int m, int c) { model->s(m)[c] = 0; });
}

std::vector<double> ProjectedAngles(const Axis& axis) {
  // The integral of cos sin dtheta dphi is phi width (sin^2 upper - sin^2 lower) / 2.
  std::vector<double> angles(axis.size);
  for (int i = 0; i < axis.size; ++i) {
    const auto [a, b, width] = axis.CellOf(i);
    angles[i] = width / 2 * std::sin(b - a) * std::sin(b + a);  // without cancellation
  }
  return angles;
}

double WeightedSum(std::span<const double> weights, std::span<const double> values) {
  return std::inner_product(weights.begin(), weights.end(), values.begin(), 0.0);
}

}  // namespace trilobe
