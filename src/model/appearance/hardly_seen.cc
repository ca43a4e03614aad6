#include "model/appearance/hardly_seen.h"

#include <algorithm>
#include <numeric>

#include "model/appearance/color.h"

namespace trilobe {

std::vector<bool> HardlySeen(const BrdfTable& measured, const BrdfTable& fitted) {
  const MerlGrid& grid = measured.grid;
  const std::vector<bool> valid = ValidBins(measured);
  const auto luminance = [](const BrdfTable& table, int bin) {
    Rgb rho;
    for (int c = 0; c < kChannels; ++c) rho[c] = std::max(table.Value(c, bin), 0.0);
    return Luminance(rho);
  };
  const int bins = grid.theta_h * grid.theta_d;
  std::vector<double> light(bins), density(bins);
  std::vector<int> order;
  for (int k = 0; k < bins; ++k) {
    const int h = k / grid.theta_d, d = k % grid.theta_d;
    int count = 0;
    for (int p = 0; p < grid.phi_d; ++p) {
      const int bin = grid.Index(h, d, p);
      if (!valid[bin]) continue;
      const double rho = std::max(luminance(measured, bin), luminance(fitted, bin));
      const Cosines cosines = ToCosines(grid.Center(h, d, p));
      density[k] += rho * cosines.i * cosines.o;
      ++count;
    }
    if (count == 0) continue;
    light[k] = density[k] * grid.SolidAngle(h, d);
    density[k] /= count;
    order.push_back(k);
  }
  std::ranges::stable_sort(order, {}, [&](int k) { return density[k]; });
  const double most = kHardlySeen * std::accumulate(light.begin(), light.end(), 0.0);
  std::vector<bool> hardly(bins);
  double sum = 0;
  for (const int k : order) {
    sum += light[k];
    if (sum > most) break;
    hardly[k] = true;
  }
  return hardly;
}

}  // namespace trilobe
