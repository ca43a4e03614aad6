#include "model/lobes/gauge.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "model/lobes/canonical_scale.h"
#include "model/lobes/continuation.h"
#include "model/lobes/lobes.h"
#include "model/lobes/scale.h"
#include "trilobe/core/base/check.h"
#include "trilobe/model/lobes/lobe_light.h"

namespace trilobe {

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
      Divide(factor, t, WeightedSum(angles, table), model);
      return;
    }
    const auto weights = coverage.subspan(model->TableOffset(factor, t), table.size());
    const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
    Divide(factor, t, WeightedSum(weights, table) / total, model);
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
  // The coverage of D is that of its lobe's stretch.
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
