#include "experiments/stiff/agreement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace trilobe {
namespace {

// The model with lobe order[m] in place m.
FactorModel Reordered(const FactorModel& model, const std::vector<int>& order) {
  const ModelSpec& spec = model.spec();
  FactorModel result = model;
  for (int m = 0; m < spec.lobes; ++m) {
    std::ranges::copy(model.s(order[m]), result.s(m).begin());
    for (const Factor factor : kFactors) {
      for (int c = 0; c < kChannels; ++c) {
        const int target = spec.table(factor, m, c);
        std::ranges::copy(model.table(factor, spec.table(factor, order[m], c)),
                          result.table(factor, target).begin());
      }
    }
  }
  return result;
}

// Entries below this share of their table, or of the largest d or s, count as 0: their errors are
// relative to that maximum.
constexpr double kNothing = 1e-12;

// Largest right value of d and s.
double LargestValue(const FactorModel& right) {
  const int values = kChannels * (1 + right.spec().lobes);
  const double largest = std::ranges::max(right.parameters().first(values));
  return largest > 0 ? largest : 1;
}

// The digits, and the sum of the relative errors of all tables, by which orders are told apart.
struct Comparison {
  TableAgreement agreement;
  double error = 0;
};

Comparison CompareInOrder(const FactorModel& model, const FactorModel& right,
                          const std::vector<bool>& determined) {
  Comparison comparison;
  const double largest = LargestValue(right);
  const auto x = model.parameters(), x0 = right.parameters();
  for (const auto [begin, size] : right.Parts()) {
    double scale = 0;
    for (int k = begin; k < begin + size; ++k) {
      if (determined[k]) scale = std::max(scale, x0[k]);
    }
    const bool of_table = begin >= kChannels * (1 + right.spec().lobes);
    if (!of_table && scale < kNothing * largest) scale = largest;
    double error = 0;
    TableAgreement& agreement = comparison.agreement;
    for (int k = begin; k < begin + size; ++k) {
      if (!determined[k]) continue;
      const double of_entry = x0[k] < kNothing * scale ? scale : x0[k];
      error = std::max(error, std::abs(x[k] - x0[k]) / scale);
      agreement.tables = std::min(agreement.tables, DigitsOfAgreement(x[k], x0[k], scale));
      agreement.entries = std::min(agreement.entries, DigitsOfAgreement(x[k], x0[k], of_entry));
    }
    comparison.error += error;
  }
  return comparison;
}

}  // namespace

double DigitsOfAgreement(double value, double right, double scale) {
  if (value == right) return kMaxDigits;
  const double error = std::abs(value - right) / scale;
  if (!std::isfinite(error)) return 0;
  return error < 1 ? std::min(-std::log10(error), kMaxDigits) : 0;
}

FactorModel MatchLobes(const FactorModel& model, const FactorModel& right,
                       const std::vector<bool>& determined) {
  std::vector<int> order(right.spec().lobes);
  std::iota(order.begin(), order.end(), 0);
  FactorModel best = model;
  double least = CompareInOrder(model, right, determined).error;
  while (std::ranges::next_permutation(order).found) {
    FactorModel other = Reordered(model, order);
    const double error = CompareInOrder(other, right, determined).error;
    if (!(error < least)) continue;
    least = error;
    best = std::move(other);
  }
  return best;
}

TableAgreement CompareTables(const FactorModel& model, const FactorModel& right,
                             const std::vector<bool>& determined) {
  return CompareInOrder(MatchLobes(model, right, determined), right, determined).agreement;
}

}  // namespace trilobe
