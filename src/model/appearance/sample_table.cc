#include "model/appearance/sample_table.h"

#include <algorithm>
#include <vector>

namespace trilobe {
namespace {

constexpr MerlGrid kGrids[] = {{.theta_h = 90, .theta_d = 30, .phi_d = 36},
                               {.theta_h = 60, .theta_d = 18, .phi_d = 24},
                               {.theta_h = 45, .theta_d = 15, .phi_d = 18},
                               {.theta_h = 30, .theta_d = 12, .phi_d = 12}};
constexpr int kSamples = 4;      // for each bin above the surface
constexpr double kFilled = 0.6;  // of these; what is next to a gap would fill it

}  // namespace

std::optional<BrdfTable> TableOfSamples(const Measurement& scattered) {
  if (scattered.anisotropic) return std::nullopt;
  const BrdfSamples& samples = scattered.samples;
  for (const MerlGrid& grid : kGrids) {
    const std::vector<bool> above = BinsAboveSurface(grid);
    const auto bins = std::ranges::count(above, true);
    if (samples.size() < kSamples * bins) continue;
    std::vector<Rgb> sums(grid.size());
    std::vector<int> counts(grid.size());
    for (int j = 0; j < samples.size(); ++j) {
      const int bin = grid.Bin(samples.Angles(j));
      ++counts[bin];
      for (int c = 0; c < kChannels; ++c) sums[bin][c] += samples.rho[j][c];
    }
    int filled = 0;
    BrdfTable table = MakeInvalidTable(scattered.source, grid);
    for (int bin = 0; bin < grid.size(); ++bin) {
      if (!above[bin] || counts[bin] == 0) continue;
      ++filled;
      for (int c = 0; c < kChannels; ++c) {
        table.SetValue(c, bin, sums[bin][c] / counts[bin]);
      }
    }
    if (filled >= kFilled * static_cast<double>(bins)) return table;
  }
  return std::nullopt;
}

}  // namespace trilobe
