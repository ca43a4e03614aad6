#include "trilobe/model/brdf_samples.h"

#include <algorithm>

#include "trilobe/base/error.h"

namespace trilobe {

double BrdfSamples::SolidAngle(int j) const {
  if (!on_grid()) return 1;
  const int row = bins[j] / grid.phi_d;
  return grid.SolidAngle(row / grid.theta_d, row % grid.theta_d);
}

BrdfSamples ValidSamples(const BrdfTable& table) {
  BrdfSamples samples{table.source, table.grid, {}, {}, {}};
  const std::vector<bool> valid = ValidBins(table);
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    if (!valid[bin]) continue;
    samples.bins.push_back(bin);
    samples.rho.push_back({table.Value(0, bin), table.Value(1, bin), table.Value(2, bin)});
  }
  if (samples.rho.empty()) {
    throw Error(table.source +
                ": no valid bin: nowhere are both directions above the surface and all three "
                "values finite and >= 0" +
                (table.unmeasured.empty()
                     ? "; check that the file is a BRDF in MERL layout"
                     : " where it was measured; --max_angle and --extrapolated say what counts"));
  }
  return samples;
}

BrdfSamples Selected(const BrdfSamples& samples, const std::vector<int>& numbers) {
  BrdfSamples selected{samples.source, samples.grid, {}, {}, {}};
  for (const int j : numbers) {
    if (samples.on_grid()) {
      selected.bins.push_back(samples.bins[j]);
    } else {
      selected.angles.push_back(samples.angles[j]);
    }
    selected.rho.push_back(samples.rho[j]);
    if (!samples.multiplicity.empty()) selected.multiplicity.push_back(samples.multiplicity[j]);
  }
  return selected;
}

BrdfSamples Thinned(const BrdfSamples& samples, int stride) {
  const MerlGrid& grid = samples.grid;
  std::vector<int> kept;
  for (int j = 0; j < samples.size(); ++j) {
    int phase = j;
    if (samples.on_grid()) {
      const int bin = samples.bins[j], row = bin / grid.phi_d, p = bin % grid.phi_d;
      // Primes, which have no common factor with a smaller stride, so that neighbouring rows
      // differ.
      phase =
          std::min(p, grid.phi_d - 1 - p) + 29 * (row / grid.theta_d) + 37 * (row % grid.theta_d);
    }
    if (phase % stride == 0) kept.push_back(j);
  }
  return Selected(samples, kept);
}

}  // namespace trilobe
