#include "model/lobes/lobe_match.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>

#include "model/lobes/gauge.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Sums for the cosine of the angle between two arrays, which may come in parts.
struct Congruence {
  double both = 0, a = 0, b = 0;

  void Add(double weight, double x, double y) {
    both += weight * x * y;
    a += weight * x * x;
    b += weight * y * y;
  }
  double value() const { return a > 0 && b > 0 ? both / (std::sqrt(a) * std::sqrt(b)) : 0; }
};

// The largest entry, or 1: arrays are divided by it before they are squared.
double ScaleOf(std::span<const double> values) {
  const double largest = values.empty() ? 0 : std::ranges::max(values);
  return largest > 0 ? largest : 1;
}

bool IsObserved(const ModelFile& file, int parameter) {
  return file.unobserved.empty() || !file.unobserved[parameter];
}

// Of the tables of a lobe, one for each channel that has its own.
double FactorCongruence(Factor factor, std::span<const double> weights, const ModelFile& a,
                        int a_lobe, const ModelFile& b, int b_lobe) {
  const ModelSpec& spec = a.model.spec();
  const int channels = spec.sharing(factor).per_channel ? kChannels : 1;
  Congruence sums;
  for (int c = 0; c < channels; ++c) {
    const int a_table = spec.table(factor, a_lobe, c), b_table = spec.table(factor, b_lobe, c);
    const std::span<const double> x = a.model.table(factor, a_table);
    const std::span<const double> y = b.model.table(factor, b_table);
    const double x_scale = ScaleOf(x), y_scale = ScaleOf(y);
    for (size_t k = 0; k < x.size(); ++k) {
      const int entry = static_cast<int>(k);
      if (IsObserved(a, a.model.TableOffset(factor, a_table) + entry) &&
          IsObserved(b, b.model.TableOffset(factor, b_table) + entry)) {
        sums.Add(weights.empty() ? 1 : weights[k], x[k] / x_scale, y[k] / y_scale);
      }
    }
  }
  return sums.value();
}

}  // namespace

double LobeMatch(const ModelFile& a, int a_lobe, const ModelFile& b, int b_lobe) {
  const ModelSpec& spec = a.model.spec();
  CheckSameSpec(b.model.spec(), spec);
  Congruence s;
  const double a_scale = ScaleOf(a.model.s(a_lobe)), b_scale = ScaleOf(b.model.s(b_lobe));
  for (int c = 0; c < kChannels; ++c) {
    s.Add(1, a.model.s(a_lobe)[c] / a_scale, b.model.s(b_lobe)[c] / b_scale);
  }
  const double D = FactorCongruence(Factor::kD, ProjectedAngles(spec.d_axis), a, a_lobe, b, b_lobe);
  const double G = FactorCongruence(Factor::kG, {}, a, a_lobe, b, b_lobe);
  const double F = spec.F.per_lobe ? FactorCongruence(Factor::kF, {}, a, a_lobe, b, b_lobe) : 1.0;
  return s.value() * D * F * G;
}

double LobeOrderMatch::least() const { return match.empty() ? 1 : std::ranges::min(match); }

LobeOrderMatch MatchLobes(const ModelFile& reference, const ModelFile& model) {
  CheckSameSpec(model.model.spec(), reference.model.spec());
  const int lobes = reference.model.spec().lobes;
  std::vector<std::vector<double>> table(lobes, std::vector<double>(lobes));
  for (int m = 0; m < lobes; ++m) {
    for (int n = 0; n < lobes; ++n) table[m][n] = LobeMatch(reference, m, model, n);
  }
  std::vector<int> order(lobes);
  std::iota(order.begin(), order.end(), 0);
  LobeOrderMatch best{.lobe = order, .match = {}};
  double most = -1;
  do {  // at most 8! = 40,320
    double sum = 0;
    for (int m = 0; m < lobes; ++m) sum += table[m][order[m]];
    if (sum > most) {
      most = sum;
      best.lobe = order;
    }
  } while (std::ranges::next_permutation(order).found);
  for (int m = 0; m < lobes; ++m) best.match.push_back(table[m][best.lobe[m]]);
  return best;
}

}  // namespace trilobe
