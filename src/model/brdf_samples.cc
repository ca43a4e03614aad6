#include "trilobe/model/brdf_samples.h"

#include "trilobe/base/error.h"

namespace trilobe {

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
                "values finite and >= 0; check that the file is a BRDF in MERL layout");
  }
  return samples;
}

}  // namespace trilobe
