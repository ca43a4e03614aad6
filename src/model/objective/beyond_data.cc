#include "model/objective/beyond_data.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/quantile.h"
#include "core/base/robust_line.h"
#include "trilobe/core/base/check.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/objective/lobe_light.h"

namespace trilobe {
namespace {

constexpr int kLookedAt = 5;

// Linear between two observed bins. Beyond the last one, the median of the last `looked_at`: a
// single bin at the edge of the data is unreliable.
void FillUnobservedBins(std::span<const double> coverage, int looked_at, std::span<double> table) {
  const int size = static_cast<int>(table.size());
  std::vector<double> last;  // observed values so far, at most `looked_at`
  int left = -1;             // the last observed bin before the gap
  for (int k = 0; k <= size; ++k) {
    if (k < size && !(coverage[k] > 0)) continue;
    if (left < 0 && k == size) return;  // no observed bin at all
    const double beyond = k == size ? UpperMedian(last) : 0;
    for (int gap = left + 1; gap < k; ++gap) {
      const double t = static_cast<double>(gap - left) / (k - left);
      table[gap] = left < 0 ? table[k] : k == size ? beyond : (1 - t) * table[left] + t * table[k];
    }
    left = k;
    if (k == size) break;
    last.push_back(table[k]);
    if (static_cast<int>(last.size()) > looked_at) last.erase(last.begin());
  }
}

// Linear between observed nodes around each ring of equal theta. A ring without any copies the ring
// inside it or, if there is none, the one outside.
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
  const auto copy = [&](int from, int target) {
    if (from < 0 || from >= rings || !filled[from] || filled[target]) return;
    std::ranges::copy(table.subspan(from * columns, columns), table.begin() + target * columns);
    filled[target] = true;
  };
  for (int a = 1; a < rings; ++a) copy(a - 1, a);
  for (int a = rings - 2; a >= 0; --a) copy(a + 1, a);
}

void FillUnobserved(const Axis& axis, std::span<const double> coverage, int looked_at,
                    std::span<double> table) {
  if (axis.polar()) {
    FillUnobservedNodes(axis, coverage, table);
  } else {
    FillUnobservedBins(coverage, looked_at, table);
  }
}

// The last observed entries that enough samples read to say how the table goes on: up to kLine,
// without the last few that are not well covered.
std::vector<int> TrustedEntries(std::span<const double> coverage, std::span<const double> table) {
  constexpr int kLine = 10, kMostLeftOut = 4;
  int end = static_cast<int>(coverage.size());
  while (end > 0 && !(coverage[end - 1] > 0)) --end;
  for (int k = 0; k < kMostLeftOut && end > 0 && !IsWellCovered(coverage, end - 1); ++k) --end;
  std::vector<int> trusted;
  for (int k = end - 1; k >= 0 && static_cast<int>(trusted.size()) < kLine; --k) {
    if (coverage[k] > 0 && table[k] > 0) trusted.push_back(k);
  }
  std::ranges::reverse(trusted);
  return trusted;
}

// Fills unobserved bins of F or of G / cos theta: linear between observed ones; beyond the last one
// the logarithm goes on as it does over the last that are well covered, and levels off.
void ContinueBins(const Axis& axis, std::span<const double> coverage, std::span<double> table) {
  constexpr int kFewest = 4;
  FillUnobservedBins(coverage, kLookedAt, table);
  const std::vector<int> trusted = TrustedEntries(coverage, table);
  if (static_cast<int>(trusted.size()) < kFewest) return;
  std::vector<double> x, y;
  for (const int k : trusted) {
    x.push_back(axis.Theta(k));
    y.push_back(std::log(table[k]));
  }
  const RobustLine line = FitRobustLine(x, y);
  for (int k = axis.size - 1; k > trusted.back() && !(coverage[k] > 0); --k) {
    table[k] = std::exp(LevelledOff(line, x.back(), axis.Theta(k)));
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
  if (axis.polar()) {
    FillUnobservedNodes(axis, coverage, ratio);
    ContinueRings(axis, coverage, ratio);
  } else {
    ContinueBins(axis, coverage, ratio);
  }
  for (int k = 0; k < axis.size; ++k) {
    if (!(coverage[k] > 0)) G[k] = ratio[k] * std::cos(axis.Theta(k));
  }
}

// Calls what(factor, coverage, table) for each table with an observed entry.
template <typename What>
void ForEachObservedTable(std::span<const double> coverage, FactorModel* model, const What& what) {
  const ModelSpec& spec = model->spec();
  for (const Factor factor : kFactors) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      const std::span<double> table = model->table(factor, t);
      const auto covered = coverage.subspan(model->TableOffset(factor, t), table.size());
      if (std::ranges::any_of(covered, [](double w) { return w > 0; })) {
        what(factor, covered, table);
      }
    }
  }
}

// Beyond the last observed half vector D would be constant, while G^2 / (cos cos) may grow a
// thousandfold: F and G compensate each other along a highlight, and a lobe that is dark where
// measured would outshine all others next to it. So D is reduced there until the lobe reflects no
// more per half vector than about the last observed ones.
void DimBeyondData(std::span<const double> coverage, int num_threads, FactorModel* model) {
  const ModelSpec& spec = model->spec();
  if (spec.d_axis.polar() || spec.lobes == 0) return;
  std::vector<std::vector<int>> observed(spec.num_tables(Factor::kD));
  bool any = false;
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    const int offset = model->TableOffset(Factor::kD, t);
    for (int k = 0; k < spec.d_axis.size; ++k) {
      if (coverage[offset + k] > 0) observed[t].push_back(k);
    }
    any = any || (!observed[t].empty() && observed[t].back() < spec.d_axis.size - 1);
  }
  if (!any) return;
  // A lobe with all factors 1 counts the half vectors that read an entry.
  FactorModel flat(spec);
  std::ranges::fill(flat.parameters(), 1.0);
  const std::vector<double> everywhere(coverage.size(), 1);
  const LobeLight light = ComputeLobeLight(everywhere, *model, num_threads);
  const LobeLight of_flat = ComputeLobeLight(everywhere, flat, num_threads);
  for (int t = 0; t < spec.num_tables(Factor::kD); ++t) {
    const int offset = model->TableOffset(Factor::kD, t);
    const auto reflected = [&](int k) {
      const double half_vectors = of_flat.through[offset + k];
      return half_vectors > 0 ? light.through[offset + k] / half_vectors : 0;
    };
    if (observed[t].empty()) continue;
    std::vector<double> last;
    for (const int k :
         std::span(observed[t]).last(std::min<size_t>(observed[t].size(), kLookedAt))) {
      last.push_back(reflected(k));
    }
    const double most = UpperMedian(last);
    for (int k = observed[t].back() + 1; k < spec.d_axis.size; ++k) {
      if (reflected(k) > most) model->table(Factor::kD, t)[k] *= most / reflected(k);
    }
  }
}

}  // namespace

void FillFromNeighbors(std::span<const double> coverage, FactorModel* model) {
  CheckCoverage(coverage, NotNull(model, "the model"));
  ForEachObservedTable(coverage, model, [&](Factor factor, const auto& covered, const auto& table) {
    FillUnobserved(model->spec().axis(factor), covered, 1, table);
  });
}

void ContinueBeyondData(std::span<const double> coverage, int num_threads, FactorModel* model) {
  CheckCoverage(coverage, NotNull(model, "the model"));
  const FactorModel before = *model;
  ForEachObservedTable(coverage, model, [&](Factor factor, const auto& covered, const auto& table) {
    const Axis& axis = model->spec().axis(factor);
    if (factor == Factor::kG) {
      ContinueShadowing(axis, covered, table);
    } else if (factor == Factor::kF) {
      ContinueBins(axis, covered, table);
    } else {
      FillUnobserved(axis, covered, kLookedAt, table);
    }
  });
  DimBeyondData(coverage, num_threads, model);
  // Keeps values that are correct up to rounding: repeating this changes no bit.
  constexpr double kRounding = 1e-13;
  for (size_t k = 0; k < coverage.size(); ++k) {
    double& x = model->parameters()[k];
    if (std::abs(x - before.parameters()[k]) <= kRounding * x) x = before.parameters()[k];
  }
}

}  // namespace trilobe
