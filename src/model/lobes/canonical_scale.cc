#include "model/lobes/canonical_scale.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "model/lobes/scale.h"

namespace trilobe {
namespace {

// exp(mean of log x) of the entries that have a weight and are not 0; 0 where there are none.
// Relative to the entry of most weight, so that logarithms stay small where weight is.
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

// By lobe and channel what is reflected and 4 s, of those that reflect; and by table of F and G
// what s has gained by its scale: F loses as much, G the root of it.
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
  // G as well, though its scale will follow: so that s is no extreme number on the way.
  ForEachObservedTable(coverage, model, [&](Factor factor, int t) {
    if (factor == Factor::kD) return;
    const std::span<const double> table = model.table(factor, t);
    const auto through =
        std::span(light.through).subspan(model.TableOffset(factor, t), table.size());
    double mean = GeometricMean(through, table);
    // Without light any entry is as good as the others.
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

// Scales each table of a factor so that the lobes and channels that it serves have the sum of 4 s
// that they reflect; by how much the sums were off at most, relative.
double Fit(const ModelSpec& spec, Factor factor, Balance* balance) {
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

// F and G can still exchange scale where they serve the same lobes and channels: there the tables
// of F get back their geometric mean, 1, taken together.
void ShareScale(const ModelSpec& spec, std::span<const double> F_before, Balance* balance) {
  // Lobes that share one of the two hang together, and so do channels.
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

}  // namespace

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

void ScaleByLight(std::span<const double> coverage, const LobeLight& light, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  const std::vector<double> half_vectors =
      spec.d_axis.polar() ? ProjectedAngles(spec.d_axis) : VisibleSolidAngles(spec.d_axis.size);
  ForEachObservedTable(coverage, *model, [&](Factor factor, int t) {
    if (factor != Factor::kD) return;
    Divide(factor, t, WeightedSum(half_vectors, model->table(factor, t)), model);
  });
  // Iterative proportional fitting (Deming and Stephan 1940). What s ends as is unique; begun with
  // G, whose scale is arbitrary here, the tables are as well. Of 63 measured materials 3 to 61
  // passes do.
  constexpr int kMostPasses = 1000;
  constexpr double kRounding = 1e-14;
  Balance balance = MakeBalance(coverage, light, *model);
  const std::vector<double> F_before = balance.F_gain;
  Fit(spec, Factor::kG, &balance);
  for (int k = 0; k < kMostPasses && Fit(spec, Factor::kF, &balance) > kRounding; ++k) {
    Fit(spec, Factor::kG, &balance);
  }
  ShareScale(spec, F_before, &balance);
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    Divide(Factor::kF, t, balance.F_gain[t], model);
  }
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    Divide(Factor::kG, t, std::sqrt(balance.G_gain[t]), model);
  }
}

}  // namespace trilobe
