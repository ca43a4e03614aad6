#include "model/objective/lobe_match.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "model/objective/gauge.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/lobe_light.h"

namespace trilobe {
namespace {

// Sums for the cosine of the angle between two arrays.
struct Cosine {
  double both = 0, a = 0, b = 0;

  void Add(double weight, double x, double y) {
    both += weight * x * y;
    a += weight * x * x;
    b += weight * y * y;
  }
  double value() const {
    return a > 0 && b > 0 ? std::min(both / (std::sqrt(a) * std::sqrt(b)), 1.0) : 0;
  }
};

// The largest entry, or 1: arrays are divided by it before they are squared.
double ScaleOf(std::span<const double> values) {
  const double largest = values.empty() ? 0 : std::ranges::max(values);
  return largest > 0 ? largest : 1;
}

bool IsObserved(const ModelFile& file, int parameter) {
  return file.unobserved.empty() || !file.unobserved[parameter];
}

double TableCosine(Factor factor, std::span<const double> weights, const ModelFile& a, int a_table,
                   const ModelFile& b, int b_table) {
  const std::span<const double> x = a.model.table(factor, a_table);
  const std::span<const double> y = b.model.table(factor, b_table);
  const double x_scale = ScaleOf(x), y_scale = ScaleOf(y);
  Cosine cosine;
  for (size_t k = 0; k < x.size(); ++k) {
    const int entry = static_cast<int>(k);
    if (IsObserved(a, a.model.TableOffset(factor, a_table) + entry) &&
        IsObserved(b, b.model.TableOffset(factor, b_table) + entry)) {
      cosine.Add(weights[k], x[k] / x_scale, y[k] / y_scale);
    }
  }
  return cosine.value();
}

std::vector<Rgb> LightOf(const ModelFile& file) {
  std::vector<bool> unobserved = file.unobserved;
  unobserved.resize(file.model.parameters().size(), false);
  return ComputeLobeLight(ObservedEntries(unobserved), file.model).lobes;
}

double Sum(const Rgb& light) { return light[0] + light[1] + light[2]; }

double SumOver(const std::vector<Rgb>& lobes) {
  double sum = 0;
  for (const Rgb& light : lobes) sum += Sum(light);
  return sum;
}

// A lobe of a model, and the light that it reflects.
struct LitLobe {
  const ModelFile& file;
  int lobe;
  const Rgb& light;
};

double MatchOf(const LitLobe& a, const LitLobe& b) {
  if (a.file.model.spec().stretches.of(a.lobe) != b.file.model.spec().stretches.of(b.lobe)) {
    return 0;
  }
  double shared = 0, either = 0;
  Rgb of_both{};
  for (int c = 0; c < kChannels; ++c) {
    shared += std::min(a.light[c], b.light[c]);
    either += std::max(a.light[c], b.light[c]);
    of_both[c] = a.light[c] + b.light[c];
  }
  double match = either > 0 ? shared / either : 0;
  for (const Factor factor : kFactors) {
    match *= FactorCosine(factor, a.file, a.lobe, b.file, b.lobe, of_both);
  }
  return match;
}

}  // namespace

double FactorCosine(Factor factor, const ModelFile& a, int a_lobe, const ModelFile& b, int b_lobe,
                    const Rgb& light) {
  const ModelSpec& spec = a.model.spec();
  const std::vector<double> weights = ProjectedAngles(spec.axis(factor));
  double sum = 0;
  for (int c = 0; c < kChannels; ++c) {
    if (!(light[c] > 0)) continue;
    sum += light[c] * TableCosine(factor, weights, a, spec.table(factor, a_lobe, c), b,
                                  b.model.spec().table(factor, b_lobe, c));
  }
  return sum > 0 ? sum / Sum(light) : 0;
}

bool HaveComparableLobes(const ModelSpec& a, const ModelSpec& b) {
  return std::ranges::all_of(kFactors, [&](Factor factor) {
    return a.sharing(factor) == b.sharing(factor) && a.axis(factor) == b.axis(factor);
  });
}

LobeMatch MatchLobes(const ModelFile& reference, const ModelFile& model) {
  if (!HaveComparableLobes(reference.model.spec(), model.model.spec())) {
    throw Error(ErrorKind::kMismatch,
                "lobes can be matched only of models of the same sharing and axes")
        .About("spec");
  }
  const std::vector<Rgb> reference_light = LightOf(reference), light = LightOf(model);
  const auto rows = reference_light.size(), columns = light.size();
  const size_t size = std::max(rows, columns);
  // A lobe without a partner has a match of 0.
  std::vector<std::vector<double>> match(size, std::vector<double>(size)), weighted = match;
  for (size_t m = 0; m < rows; ++m) {
    for (size_t n = 0; n < columns; ++n) {
      match[m][n] = MatchOf({reference, static_cast<int>(m), reference_light[m]},
                            {model, static_cast<int>(n), light[n]});
      weighted[m][n] = match[m][n] * (Sum(reference_light[m]) + Sum(light[n]));
    }
  }
  std::vector<int> order(size);
  std::iota(order.begin(), order.end(), 0);
  std::vector<int> best = order;
  double most = -1;
  do {  // at most 8! = 40,320
    double sum = 0;
    for (size_t m = 0; m < size; ++m) sum += weighted[m][order[m]];
    if (sum > most) {
      most = sum;
      best = order;
    }
  } while (std::ranges::next_permutation(order).found);
  LobeMatch result;
  for (size_t m = 0; m < rows; ++m) {
    const bool has_partner = best[m] < static_cast<int>(columns);
    result.lobe.push_back(has_partner ? best[m] : -1);
    result.match.push_back(has_partner ? match[m][best[m]] : 0);
  }
  const double all = SumOver(reference_light) + SumOver(light);
  if (all > 0) result.agreement = most / all;
  return result;
}

}  // namespace trilobe
