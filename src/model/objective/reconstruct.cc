#include "trilobe/model/objective/reconstruct.h"

#include <algorithm>
#include <cmath>

#include "core/base/grid_cosines.h"
#include "model/objective/unclamped_model.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// Samples per item of work.
constexpr int kChunk = 1 << 14;

// `value(j)` for j < size, in parallel.
template <typename Value>
std::vector<Rgb> ForEach(int size, int num_threads, const Value& value) {
  std::vector<Rgb> values(size);
  ParallelFor((size + kChunk - 1) / kChunk, num_threads, [&](int chunk) {
    const int end = std::min(size, (chunk + 1) * kChunk);
    for (int j = chunk * kChunk; j < end; ++j) values[j] = value(j);
  });
  return values;
}

}  // namespace

std::vector<Rgb> UnclampedSamples(const FactorModel& model, const BrdfSamples& samples,
                                  int num_threads) {
  CheckSamples(samples);
  const ModelSpec& spec = model.spec();
  if (spec.anisotropic()) {
    if (samples.directions.empty()) {
      throw ErrorIn(ErrorKind::kMissing, samples.source,
                    "an anisotropic model needs the samples' azimuths")
          .About("directions");
    }
    return ForEach(samples.size(), num_threads, [&](int j) {
      const SampleStencils at = ScatteredStencils(spec, samples.directions[j]);
      return Rgb{UnclampedValue(model, at, 0), UnclampedValue(model, at, 1),
                 UnclampedValue(model, at, 2)};
    });
  }
  const bool own_bins = samples.on_grid() && samples.grid.theta_h == spec.d_axis.size &&
                        samples.grid.theta_d == spec.f_axis.size && !spec.stretches.any();
  const UnclampedModel unclamped(model);
  if (own_bins) {
    const GridCosines cosines(samples.grid);
    return ForEach(samples.size(), num_threads, [&](int j) {
      const int row = samples.bins[j] / samples.grid.phi_d;
      const Stencil D = PointStencil(row / samples.grid.theta_d);
      return unclamped({&D, 1}, PointStencil(row % samples.grid.theta_d), cosines(samples.bins[j]));
    });
  }
  return ForEach(samples.size(), num_threads, [&](int j) {
    const HalfDiffAngles angles = samples.Angles(j);
    return unclamped(angles, ToCosines(angles));
  });
}

std::vector<Rgb> EvaluateSamples(const FactorModel& model, const BrdfSamples& samples,
                                 int num_threads) {
  std::vector<Rgb> rho = UnclampedSamples(model, samples, num_threads);
  for (Rgb& value : rho) value = AtLeastZero(value);
  return rho;
}

BrdfTable Reconstruct(const FactorModel& model, const std::string& source, const MerlGrid& grid,
                      int num_threads) {
  BrdfTable table = MakeInvalidTable(source, grid);
  const std::vector<bool> above = BinsAboveSurface(grid);
  // A tenth of the bins at a time, as samples take more memory than the table.
  const int step = std::max(grid.size() / 10, 1);
  for (int begin = 0; begin < grid.size(); begin += step) {
    BrdfSamples samples{source, grid, {}, {}, {}};
    for (int bin = begin; bin < std::min(begin + step, grid.size()); ++bin) {
      if (above[bin]) samples.bins.push_back(bin);
    }
    samples.rho.resize(samples.bins.size());
    const std::vector<Rgb> rho = EvaluateSamples(model, samples, num_threads);
    for (int j = 0; j < samples.size(); ++j) {
      for (int c = 0; c < kChannels; ++c) {
        table.SetValue(c, samples.bins[j], rho[j][c]);
        if (!std::isfinite(table.stored[c][samples.bins[j]])) {
          throw ErrorIn(ErrorKind::kData, source,
                        "the model's value overflows at bin " + std::to_string(samples.bins[j]) +
                            "; its factors are too large")
              .About("model", "overflow");
        }
      }
    }
  }
  return table;
}

}  // namespace trilobe
