#include "solvers/gaussian_filter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "trilobe/core/base/check.h"

namespace trilobe {

void SmoothG(double sigma, std::span<const double> coverage, FactorModel* model) {
  const ModelSpec& spec = NotNull(model, "the model").spec();
  CheckNumber("sigma", sigma, sigma > 0, "above 0");
  CheckCoverage(coverage, *model);
  CheckIsotropic(spec, "the Gaussian filter on G");
  const int radius =
      static_cast<int>(std::min(std::ceil(3 * sigma), static_cast<double>(spec.g_axis.size)));
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    const std::span<double> G = model->table(Factor::kG, t);
    const auto observed = coverage.subspan(model->TableOffset(Factor::kG, t), G.size());
    const std::vector<double> old(G.begin(), G.end());
    for (int k = 0; k < spec.g_axis.size; ++k) {
      if (!(observed[k] > 0)) continue;
      double sum = 0, weights = 0;
      for (int j = std::max(0, k - radius); j <= std::min(spec.g_axis.size - 1, k + radius); ++j) {
        if (!(observed[j] > 0)) continue;
        const double z = (j - k) / sigma;
        const double weight = std::exp(-z * z / 2);
        sum += weight * old[j];
        weights += weight;
      }
      G[k] = sum / weights;
    }
  }
}

}  // namespace trilobe
