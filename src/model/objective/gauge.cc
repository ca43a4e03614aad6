#include "model/objective/gauge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>

#include "model/objective/beyond_data.h"
#include "model/objective/lobes.h"
#include "trilobe/core/base/check.h"
#include "trilobe/model/objective/lobe_light.h"

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

// Calls what(lobe, channel) for each lobe and channel of the table.
template <typename What>
void ForEachServed(const ModelSpec& spec, Factor factor, int index, const What& what) {
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      if (spec.serves(factor, index, m, c)) what(m, c);
    }
  }
}

bool AnyCovered(std::span<const double> coverage) {
  return std::ranges::any_of(coverage, [](double weight) { return weight > 0; });
}

// Calls what(factor, index) for each table with an observed entry. Tables of channels without data
// keep their scale.
template <typename What>
void ForEachObservedTable(std::span<const double> coverage, const FactorModel& model,
                          const What& what) {
  for (const Factor factor : kFactors) {
    const int size = model.spec().table_size(factor);
    for (int t = 0; t < model.spec().num_tables(factor); ++t) {
      if (AnyCovered(coverage.subspan(model.TableOffset(factor, t), size))) what(factor, t);
    }
  }
}

// Divides a table by its norm and multiplies s of its lobes by it (twice for G, which is squared).
// A norm within rounding of a power of two is rounded to it, so that the division is exact: a model
// in canonical form is unchanged to the bit, and equal tables stay equal.
void DivideTable(Factor factor, int index, double norm, FactorModel* model) {
  norm = WithoutRounding(norm);
  for (double& x : model->table(factor, index)) x /= norm;
  ForEachServed(model->spec(), factor, index,
                [&](int m, int c) { model->s(m)[c] *= factor == Factor::kG ? norm * norm : norm; });
}

// If all observed entries of a table are 0, it becomes constant, which has a norm, and s of its
// lobes 0.
void MoveZeroToS(std::span<const double> coverage, Factor factor, int index, FactorModel* model) {
  const std::span<double> table = model->table(factor, index);
  const int offset = model->TableOffset(factor, index);
  for (size_t k = 0; k < table.size(); ++k) {
    if (coverage[offset + k] > 0 && table[k] > 0) return;
  }
  std::ranges::fill(table, 1.0);
  ForEachServed(model->spec(), factor, index, [&](int m, int c) { model->s(m)[c] = 0; });
}

double WeightedSum(std::span<const double> weights, std::span<const double> values) {
  return std::inner_product(weights.begin(), weights.end(), values.begin(), 0.0);
}

// exp(mean of log x) of the nonzero entries with a weight; 0 if there are none. Computed relative
// to the entry of largest weight, to keep logarithms small.
double GeometricMean(std::span<const double> weights, std::span<const double> table) {
  double most = 0, reference = 0;
  for (size_t k = 0; k < table.size(); ++k) {
    if (table[k] > 0 && weights[k] > most) {
      most = weights[k];
      reference = table[k];
    }
  }
  double sum = 0, total = 0;
  for (size_t k = 0; k < table.size(); ++k) {
    if (!(table[k] > 0 && weights[k] > 0)) continue;
    sum += weights[k] * std::log(table[k] / reference);
    total += weights[k];
  }
  return total > 0 ? reference * std::exp(sum / total) : 0;
}

// Reflected light and 4 s of each lobe and channel that reflects, and the factor that s has gained
// from each table of F and G: F is divided by it, G by its square root.
struct Balance {
  std::vector<Rgb> reflected, four_s;
  std::vector<double> F_gain, G_gain;

  std::vector<double>& gain(Factor factor) { return factor == Factor::kF ? F_gain : G_gain; }
};

Balance MakeBalance(std::span<const double> coverage, const LobeLight& light,
                    const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  Balance balance{.reflected = std::vector<Rgb>(spec.lobes),
                  .four_s = std::vector<Rgb>(spec.lobes),
                  .F_gain = std::vector<double>(spec.num_tables(Factor::kF), 1),
                  .G_gain = std::vector<double>(spec.num_tables(Factor::kG), 1)};
  // Done for G, too, although its scale is set later, to keep s in range.
  ForEachObservedTable(coverage, model, [&](Factor factor, int t) {
    if (factor == Factor::kD) return;
    const std::span<const double> table = model.table(factor, t);
    const auto through =
        std::span(light.through).subspan(model.TableOffset(factor, t), table.size());
    double mean = GeometricMean(through, table);
    // Without light all entries have equal weight.
    if (!(mean > 0)) mean = GeometricMean(std::vector<double>(table.size(), 1), table);
    balance.gain(factor)[t] = factor == Factor::kG ? mean * mean : mean;
  });
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      const bool observed = std::ranges::all_of(kFactors, [&](Factor factor) {
        const int offset = model.TableOffset(factor, spec.table(factor, m, c));
        return AnyCovered(coverage.subspan(offset, spec.table_size(factor)));
      });
      if (!observed || !(light.lobes[m][c] > 0)) continue;
      balance.reflected[m][c] = light.lobes[m][c];
      balance.four_s[m][c] = 4 * model.s(m)[c] * balance.F_gain[spec.table(Factor::kF, m, c)] *
                             balance.G_gain[spec.table(Factor::kG, m, c)];
    }
  }
  return balance;
}

// Scales each table of a factor so that its lobes and channels, summed, reflect 4 s. Returns the
// largest relative deviation before.
double MatchReflected(const ModelSpec& spec, Factor factor, Balance* balance) {
  double off = 0;
  for (int t = 0; t < spec.num_tables(factor); ++t) {
    double reflected = 0, four_s = 0;
    ForEachServed(spec, factor, t, [&](int m, int c) {
      reflected += balance->reflected[m][c];
      four_s += balance->four_s[m][c];
    });
    if (!(reflected > 0)) continue;
    const double ratio = reflected / four_s;
    ForEachServed(spec, factor, t, [&](int m, int c) { balance->four_s[m][c] *= ratio; });
    balance->gain(factor)[t] *= ratio;
    off = std::max(off, std::abs(ratio - 1));
  }
  return off;
}

// F and G can still exchange scale if they serve the same lobes and channels: resets the joint
// geometric mean of these tables of F to 1.
void ShareScale(const ModelSpec& spec, std::span<const double> F_before, Balance* balance) {
  // Lobes that share one of the two are in one group, and so are channels.
  const bool by_lobe = spec.F.per_lobe && spec.G.per_lobe;
  const bool by_channel = spec.F.per_channel && spec.G.per_channel;
  const auto group = [&](int m, int c) {
    return kChannels * (by_lobe ? m : 0) + (by_channel ? c : 0);
  };
  std::vector<double> sum(kChannels * std::max(spec.lobes, 1)), total(sum.size());
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      const int t = spec.table(Factor::kF, m, c);
      sum[group(m, c)] += balance->reflected[m][c] * std::log(balance->F_gain[t] / F_before[t]);
      total[group(m, c)] += balance->reflected[m][c];
    }
  }
  for (const Factor factor : {Factor::kF, Factor::kG}) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      int of_table = -1;
      double reflected = 0;
      ForEachServed(spec, factor, t, [&](int m, int c) {
        of_table = group(m, c);
        reflected += balance->reflected[m][c];
      });
      if (!(reflected > 0)) continue;
      const double mean = std::exp(sum[of_table] / total[of_table]);
      balance->gain(factor)[t] *= factor == Factor::kF ? 1 / mean : mean;
    }
  }
}

// Scales the largest observed entry of each table into [1/2, 1) by a power of two, which is exact,
// so that products of entries neither overflow nor vanish. Tables of zeros become constant
// (MoveZeroToS).
void ScaleIntoRange(std::span<const double> coverage, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  std::vector<std::array<int, kChannels>> moved(spec.lobes);  // exponents, from tables to s
  ForEachObservedTable(coverage, *model, [&](Factor factor, int t) {
    MoveZeroToS(coverage, factor, t, model);
    const std::span<double> table = model->table(factor, t);
    const auto covered = coverage.subspan(model->TableOffset(factor, t), table.size());
    double largest = 0;
    for (size_t k = 0; k < table.size(); ++k) {
      if (covered[k] > 0) largest = std::max(largest, table[k]);
    }
    int exponent = 0;
    std::frexp(largest, &exponent);
    for (double& x : table) x = std::ldexp(x, -exponent);
    ForEachServed(spec, factor, t, [&](int m, int c) {
      moved[m][c] += factor == Factor::kG ? 2 * exponent : exponent;
    });
  });
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) model->s(m)[c] = std::ldexp(model->s(m)[c], moved[m][c]);
  }
}

// The canonical scale (gauge.h) of a model scaled into range; `light` is its reflected light.
void ScaleByLight(std::span<const double> coverage, const LobeLight& light, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  const std::vector<double> half_vectors =
      spec.d_axis.polar() ? ProjectedAngles(spec.d_axis) : VisibleSolidAngles(spec.d_axis.size);
  ForEachObservedTable(coverage, *model, [&](Factor factor, int t) {
    if (factor != Factor::kD) return;
    DivideTable(factor, t, WeightedSum(half_vectors, model->table(factor, t)), model);
  });
  // Iterative proportional fitting (Deming and Stephan 1940). The resulting s is unique; starting
  // with G, whose scale is arbitrary here, makes the tables unique, too. 63 measured materials took
  // 3 to 61 passes.
  constexpr int kMostPasses = 1000;
  constexpr double kRounding = 1e-14;
  Balance balance = MakeBalance(coverage, light, *model);
  const std::vector<double> F_before = balance.F_gain;
  MatchReflected(spec, Factor::kG, &balance);
  for (int k = 0; k < kMostPasses && MatchReflected(spec, Factor::kF, &balance) > kRounding; ++k) {
    MatchReflected(spec, Factor::kG, &balance);
  }
  ShareScale(spec, F_before, &balance);
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    DivideTable(Factor::kF, t, balance.F_gain[t], model);
  }
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    DivideTable(Factor::kG, t, std::sqrt(balance.G_gain[t]), model);
  }
}

}  // namespace

std::vector<double> ProjectedAngles(const Axis& axis) {
  // The integral of cos sin dtheta dphi is phi width (sin^2 upper - sin^2 lower) / 2.
  std::vector<double> angles(axis.size);
  for (int i = 0; i < axis.size; ++i) {
    const auto [a, b, width] = axis.CellOf(i);
    angles[i] = width / 2 * std::sin(b - a) * std::sin(b + a);  // without cancellation
  }
  return angles;
}

double ProjectedIntegral(const Axis& axis, std::span<const double> D) {
  const std::vector<double> angles = ProjectedAngles(axis);
  CheckSize("D", D.size(), angles.size());
  return WeightedSum(angles, D);
}

std::vector<bool> UnobservedParameters(std::span<const double> coverage) {
  std::vector<bool> unobserved(coverage.size());
  for (size_t k = 0; k < coverage.size(); ++k) unobserved[k] = !(coverage[k] > 0);
  return unobserved;
}

std::vector<double> ObservedEntries(const std::vector<bool>& unobserved) {
  std::vector<double> observed(unobserved.size());
  for (size_t k = 0; k < unobserved.size(); ++k) observed[k] = unobserved[k] ? 0 : 1;
  return observed;
}

void CopyUnobservedParameters(std::span<const double> coverage, const FactorModel& from,
                              FactorModel* target) {
  CheckSameSpec(from.spec(), NotNull(target, "the model").spec());
  CheckCoverage(coverage, from);
  for (size_t k = 0; k < coverage.size(); ++k) {
    if (!(coverage[k] > 0)) target->parameters()[k] = from.parameters()[k];
  }
}

void NormalizeScale(std::span<const double> coverage, FactorModel* model) {
  CheckCoverage(coverage, NotNull(model, "the model"));
  FillFromNeighbors(coverage, model);
  const std::vector<double> angles = ProjectedAngles(model->spec().d_axis);
  ForEachObservedTable(coverage, *model, [&](Factor factor, int t) {
    const std::span<const double> table = model->table(factor, t);
    MoveZeroToS(coverage, factor, t, model);
    if (factor == Factor::kD) {
      DivideTable(factor, t, WeightedSum(angles, table), model);
      return;
    }
    const auto weights = coverage.subspan(model->TableOffset(factor, t), table.size());
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    DivideTable(factor, t, WeightedSum(weights, table) / total, model);
  });
}

void Canonicalize(std::span<const double> coverage, FactorModel* model, LobeOrder order,
                  int num_threads) {
  CheckCoverage(coverage, NotNull(model, "the model"));
  ScaleIntoRange(coverage, model);
  const LobeLight light = ComputeLobeLight(coverage, *model, num_threads);
  ContinueBeyondData(coverage, num_threads, model);
  ScaleByLight(coverage, light, model);
  const ModelSpec& spec = model->spec();
  // D has the coverage of its lobe's stretch.
  const bool may_change_places = !spec.stretches.several();
  if (order == LobeOrder::kByLight && spec.lobes > 1 && may_change_places) {
    std::vector<int> lobes(spec.lobes);
    std::iota(lobes.begin(), lobes.end(), 0);
    std::ranges::stable_sort(lobes, std::greater(), [&](int m) { return light.Share(m); });
    *model = WithLobes(*model, lobes);
  }
}

void SetCanonicalScale(std::span<const double> coverage, FactorModel* model, int num_threads) {
  CheckCoverage(coverage, NotNull(model, "the model"));
  ScaleIntoRange(coverage, model);
  ScaleByLight(coverage, ComputeLobeLight(coverage, *model, num_threads), model);
}

}  // namespace trilobe
