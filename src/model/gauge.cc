#include "trilobe/model/gauge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "trilobe/brdf/directions.h"
#include "trilobe/math/catmull_rom.h"
#include "trilobe/model/lobe_light.h"
#include "trilobe/model/lobes.h"

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

constexpr size_t kLookedAt = 5;

// Linear between two observed bins. Beyond the last one the median of the last `looked_at`: one
// alone, at the edge of the data, may be anything.
void FillUnobservedBins(std::span<const double> coverage, size_t looked_at,
                        std::span<double> table) {
  const int size = static_cast<int>(table.size());
  std::vector<double> last;  // observed values so far, at most `looked_at`
  int left = -1;             // the last observed bin before the gap
  for (int k = 0; k <= size; ++k) {
    if (k < size && !(coverage[k] > 0)) continue;
    if (left < 0 && k == size) return;  // no observed bin at all
    double beyond = 0;
    if (k == size) {
      std::vector<double> sorted = last;
      std::ranges::sort(sorted);
      beyond = sorted[sorted.size() / 2];
    }
    for (int gap = left + 1; gap < k; ++gap) {
      const double t = static_cast<double>(gap - left) / (k - left);
      table[gap] = left < 0 ? table[k] : k == size ? beyond : (1 - t) * table[left] + t * table[k];
    }
    left = k;
    if (k == size) break;
    last.push_back(table[k]);
    if (last.size() > looked_at) last.erase(last.begin());
  }
}

// Around each ring of one theta linearly between observed nodes; a ring without any is as the one
// inside it, or, where there is none, as the one outside it.
void FillUnobservedNodes(const Axis& axis, std::span<const double> coverage,
                         std::span<double> table) {
  const int columns = axis.phi_nodes, rings = axis.size / columns;
  std::vector<bool> filled(rings, false);
  for (int a = 0; a < rings; ++a) {
    const auto ring = table.subspan(a * columns, columns);
    const auto observed = [&](int b) { return coverage[a * columns + b % columns] > 0; };
    int first = 0;
    while (first < columns && !observed(first)) ++first;
    filled[a] = first < columns;
    for (int left = first, b = first + 1; filled[a] && b <= first + columns; ++b) {
      if (!observed(b)) continue;
      for (int gap = left + 1; gap < b; ++gap) {
        const double t = static_cast<double>(gap - left) / (b - left);
        ring[gap % columns] = (1 - t) * ring[left % columns] + t * ring[b % columns];
      }
      left = b;
    }
  }
  const auto copy = [&](int from, int to) {
    if (from < 0 || from >= rings || !filled[from] || filled[to]) return;
    std::ranges::copy(table.subspan(from * columns, columns), table.begin() + to * columns);
    filled[to] = true;
  };
  for (int a = 1; a < rings; ++a) copy(a - 1, a);
  for (int a = rings - 2; a >= 0; --a) copy(a + 1, a);
}

void FillUnobserved(const Axis& axis, std::span<const double> coverage, size_t looked_at,
                    std::span<double> table) {
  if (axis.polar()) {
    FillUnobservedNodes(axis, coverage, table);
  } else {
    FillUnobservedBins(coverage, looked_at, table);
  }
}

// Continues q = G / cos theta beyond the last ring with an observed node: 1 / q is linear in
// cos theta through the last two rings, as it nearly is for GGX, where
// 2 / q = cos theta + sqrt(cos^2 theta + alpha^2 sin^2 theta) (Walter et al. 2007, eq. 34). At most
// kMost times as large as where the data end, at least a kMost-th.
void ContinueRings(const Axis& axis, std::span<const double> coverage, std::span<double> q) {
  constexpr double kMost = 3;
  const int columns = axis.phi_nodes;
  const auto observed = std::ranges::find_if(coverage.rbegin(), coverage.rend(),
                                             [](double weight) { return weight > 0; });
  const int last = static_cast<int>(coverage.rend() - observed - 1) / columns;
  if (last < 1) return;
  const auto cosine = [&](int ring) { return std::cos(axis.Theta(ring * columns)); };
  const double step = cosine(last - 1) - cosine(last);
  for (int k = (last + 1) * columns; k < axis.size; ++k) {
    const int at = last * columns + k % columns, before = at - columns;
    // q(last) / q, which is 1 at `last` and q(last) / q(before) at the ring before it.
    const double t = (cosine(last) - cosine(k / columns)) / step;
    const double inverse = q[before] > 0 ? 1 - t * (q[at] / q[before] - 1) : 0;
    q[k] = q[at] / std::clamp(inverse, 1 / kMost, kMost);
  }
}

// Fills the unobserved nodes of G from G / cos theta of the observed ones.
void ContinueShadowing(const Axis& axis, std::span<const double> coverage, std::span<double> G) {
  std::vector<double> ratio(G.begin(), G.end());
  for (int k = 0; k < axis.size; ++k) ratio[k] /= std::cos(axis.Theta(k));
  FillUnobserved(axis, coverage, kLookedAt, ratio);
  if (axis.polar()) ContinueRings(axis, coverage, ratio);
  for (int k = 0; k < axis.size; ++k) {
    if (!(coverage[k] > 0)) G[k] = ratio[k] * std::cos(axis.Theta(k));
  }
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
  return WeightedSum(ProjectedAngles(axis), D);
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
                              FactorModel* to) {
  CheckSameSpec(from.spec(), to->spec());
  CheckCoverage(coverage, from);
  for (size_t k = 0; k < coverage.size(); ++k) {
    if (!(coverage[k] > 0)) to->parameters()[k] = from.parameters()[k];
  }
}

void NormalizeScale(std::span<const double> coverage, FactorModel* model) {
  CheckCoverage(coverage, *model);
  const ModelSpec& spec = model->spec();
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::span<double> table = model->table(factor, t);
      const auto weights = coverage.subspan(model->TableOffset(factor, t), table.size());
      const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
      if (!(total > 0)) continue;  // no data at all for these channels: nothing to normalise by
      FillUnobserved(spec.axis(factor), weights, 1, table);
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
  const std::vector<double> half_vectors =
      spec.d_axis.polar() ? ProjectedAngles(spec.d_axis) : VisibleSolidAngles(spec.d_axis.size);
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::span<double> table = model->table(factor, t);
      const size_t offset = model->TableOffset(factor, t);
      const auto covered = coverage.subspan(offset, table.size());
      const bool any = std::ranges::any_of(covered, [](double w) { return w > 0; });
      if (!any) continue;
      if (factor == Factor::kG) {
        ContinueShadowing(spec.g_axis, covered, table);
      } else {
        FillUnobserved(spec.axis(factor), covered, kLookedAt, table);
      }
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
