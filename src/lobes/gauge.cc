#include "lobes/gauge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "lobes/continuation.h"
#include "lobes/lobes.h"
#include "trilobe/base/check.h"
#include "trilobe/geometry/channels.h"
#include "trilobe/lobes/lobe_light.h"

namespace trilobe {
namespace {

// Solid angle that each entry of D stands for, projected on the surface:
// integral of cos sin dtheta dphi = phi width (sin^2 upper - sin^2 lower) / 2.
std::vector<double> ProjectedAngles(const Axis& axis) {
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

// Scales one table to norm 1 and gives the lost factor to the s that it serves (twice for G, which
// enters squared).
void Normalize(Factor factor, int index, std::span<const double> norm_weights, double norm_scale,
               FactorModel* model) {
  const std::span<double> table = model->table(factor, index);
  const double norm = WeightedSum(norm_weights, table) / norm_scale;
  // But for rounding it is 1: so equal tables stay equal, and a second time changes nothing.
  if (std::abs(norm - 1) <= 1e-14) return;
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
  const ModelSpec& spec = model->spec();
  FillFromNeighbors(coverage, model);
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::span<double> table = model->table(factor, t);
      const auto weights = coverage.subspan(model->TableOffset(factor, t), table.size());
      const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
      if (!(total > 0)) continue;  // no data at all for these channels: nothing to normalise by
      if (factor == Factor::kD) {
        Normalize(factor, t, ProjectedAngles(spec.d_axis), 1, model);
      } else {
        Normalize(factor, t, weights, total, model);
      }
    }
  }
}

void Canonicalize(std::span<const double> coverage, FactorModel* model, LobeOrder order,
                  int num_threads) {
  // Brings parameters into a range in which products neither overflow nor vanish.
  NormalizeScale(coverage, model);
  const ModelSpec& spec = model->spec();
  const LobeLight light = ComputeLobeLight(coverage, *model, num_threads);
  FactorModel through = *model;  // its numbers are the light that goes through these entries
  std::ranges::copy(light.through, through.parameters().begin());
  // The coverage of D is that of its lobe's stretch.
  const bool may_change_places = !spec.stretches.several();
  if (order == LobeOrder::kByLight && spec.lobes > 1 && may_change_places) {
    std::vector<int> lobes(spec.lobes);
    std::iota(lobes.begin(), lobes.end(), 0);
    std::ranges::stable_sort(lobes, std::greater(), [&](int m) { return light.Share(m); });
    *model = WithLobes(*model, lobes);
    through = WithLobes(through, lobes);
  }
  ContinueBeyondData(coverage, num_threads, model);
  const std::vector<double> half_vectors =
      spec.d_axis.polar() ? ProjectedAngles(spec.d_axis) : VisibleSolidAngles(spec.d_axis.size);
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::span<double> table = model->table(factor, t);
      const size_t offset = model->TableOffset(factor, t);
      const auto covered = coverage.subspan(offset, table.size());
      const bool any = std::ranges::any_of(covered, [](double w) { return w > 0; });
      if (!any) continue;
      if (factor == Factor::kD) {
        Normalize(factor, t, half_vectors, 1, model);
        continue;
      }
      std::span<const double> weights = through.table(factor, t);
      double total = std::accumulate(weights.begin(), weights.end(), 0.0);
      if (spec.anisotropic() || !(total > 0)) {  // or no light at all
        weights = covered;
        total = std::accumulate(weights.begin(), weights.end(), 0.0);
      }
      Normalize(factor, t, weights, total, model);
    }
  }
}

}  // namespace trilobe
