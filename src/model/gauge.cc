#include "trilobe/model/gauge.h"

#include <cmath>
#include <numeric>

#include "trilobe/model/directions.h"

namespace trilobe {
namespace {

// Solid angle of each theta_h bin projected on the surface:
// integral of cos sin dtheta dphi = pi (sin^2 upper - sin^2 lower).
std::vector<double> ProjectedBinAngles(int bins) {
  const MerlGrid grid{.theta_h = bins};
  std::vector<double> angles(bins);
  for (int i = 0; i < bins; ++i) {
    const double a = grid.ThetaH(i), b = grid.ThetaH(i + 1);
    angles[i] = kPi * std::sin(b - a) * std::sin(b + a);  // sin^2 b - sin^2 a, without cancellation
  }
  return angles;
}

double WeightedSum(std::span<const double> weights, std::span<const double> values) {
  return std::inner_product(weights.begin(), weights.end(), values.begin(), 0.0);
}

void FillDeadBins(std::span<const double> coverage, std::span<double> table) {
  const int size = static_cast<int>(table.size());
  int left = -1;  // the last live bin before the gap
  for (int k = 0; k <= size; ++k) {
    if (k < size && !(coverage[k] > 0)) continue;
    for (int gap = left + 1; gap < k; ++gap) {
      if (left < 0 && k == size) return;  // no live bin at all
      const double t = static_cast<double>(gap - left) / (k - left);
      table[gap] = left < 0    ? table[k]
                   : k == size ? table[left]
                               : (1 - t) * table[left] + t * table[k];
    }
    left = k;
  }
}

// Scales one table to norm 1 and gives the lost factor to the s that it serves (twice for G, which
// enters squared).
void Normalize(Factor factor, int index, std::span<const double> norm_weights, double norm_scale,
               FactorModel* model) {
  const std::span<double> table = model->table(factor, index);
  const double norm = WeightedSum(norm_weights, table) / norm_scale;
  const bool vanished = !(norm > 0);
  if (vanished) {
    const double value =
        norm_scale / std::accumulate(norm_weights.begin(), norm_weights.end(), 0.0);
    std::ranges::fill(table, value);
  } else {
    for (double& x : table) x /= norm;
  }
  const double gain = vanished ? 0 : factor == Factor::kG ? norm * norm : norm;
  const ModelSpec& spec = model->spec();
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      if (spec.serves(factor, index, m, c)) model->s(m)[c] *= gain;
    }
  }
}

}  // namespace

double ProjectedIntegral(std::span<const double> D) {
  return WeightedSum(ProjectedBinAngles(static_cast<int>(D.size())), D);
}

std::vector<bool> DeadParameters(std::span<const double> coverage) {
  std::vector<bool> dead(coverage.size());
  for (size_t k = 0; k < coverage.size(); ++k) dead[k] = !(coverage[k] > 0);
  return dead;
}

void CopyDeadParameters(std::span<const double> coverage, const FactorModel& from,
                        FactorModel* to) {
  for (size_t k = 0; k < coverage.size(); ++k) {
    if (!(coverage[k] > 0)) to->parameters()[k] = from.parameters()[k];
  }
}

void Canonicalize(std::span<const double> coverage, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::span<double> table = model->table(factor, t);
      const auto weights = coverage.subspan(model->TableOffset(factor, t), table.size());
      const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
      if (!(total > 0)) continue;  // no data at all for these channels: nothing to normalise by
      FillDeadBins(weights, table);
      if (factor == Factor::kD) {
        Normalize(factor, t, ProjectedBinAngles(spec.d_bins), 1, model);
      } else {
        Normalize(factor, t, weights, total, model);
      }
    }
  }
}

}  // namespace trilobe
