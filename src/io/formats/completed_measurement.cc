#include "io/formats/completed_measurement.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>

#include "model/appearance/picture_data.h"
#include "model/measurement/counter_random.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

constexpr int kPlaces = 20000;

using Prepared = std::shared_ptr<const PreparedModel<double>>;

Direction DrawByCosine(uint64_t counter) {
  const double r = std::sqrt(UniformAt(1, 2 * counter));
  const double phi = 2 * kPi * UniformAt(1, 2 * counter + 1);
  return {r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r * r)};
}

// Both functions of the ratio, which is that of Complete.
Rgb Ratio(const Rgb& measured, const Rgb& model, double e) {
  Rgb ratio{};
  for (int c = 0; c < kChannels; ++c) ratio[c] = (measured[c] + e) / (model[c] + e);
  return ratio;
}
Rgb Times(const Rgb& ratio, const Rgb& model, double e) {
  Rgb value{};
  for (int c = 0; c < kChannels; ++c) value[c] = std::max((model[c] + e) * ratio[c] - e, 0.0);
  return value;
}

// The offset e [1/sr]: 1 % of the mean of the measured values.
double OffsetOf(const std::vector<CompletedMeasurement::Place>& places) {
  double sum = 0;
  for (const CompletedMeasurement::Place& place : places) sum += Mean(place.measured);
  return places.empty() ? 1e-4 : 0.01 * sum / static_cast<double>(places.size());
}

struct RatioTable {
  explicit RatioTable(BrdfTable ratios) : table(std::move(ratios)), brdf(table) {}
  const BrdfTable table;
  const TabulatedBrdf brdf;
};

CompletedMeasurement CompleteTable(const BrdfTable& measured, const Prepared& model,
                                   int num_threads) {
  const std::vector<bool> valid = ValidBins(measured), above = BinsAboveSurface(measured.grid);
  const auto value_at = [&](int bin) {
    return Rgb{measured.Value(0, bin), measured.Value(1, bin), measured.Value(2, bin)};
  };
  CompletedMeasurement completed;
  for (uint64_t k = 0; k < kPlaces; ++k) {
    const int bin =
        measured.grid.Bin(ToHalfDiff(DirectionPair{DrawByCosine(2 * k), DrawByCosine(2 * k + 1)}));
    if (!valid[bin] || !(Mean(value_at(bin)) > 0)) continue;
    completed.places.push_back({ToDirections(measured.grid.Center(bin)), value_at(bin)});
  }
  const double e = OffsetOf(completed.places);
  BrdfTable ratios = MakeInvalidTable(measured.source, measured.grid);
  const int row = measured.grid.theta_d * measured.grid.phi_d;
  ParallelFor(measured.grid.theta_h, num_threads, [&](int h) {
    for (int bin = h * row; bin < (h + 1) * row; ++bin) {
      if (!above[bin]) continue;
      Rgb ratio = {1, 1, 1};
      if (valid[bin]) {
        const DirectionPair pair = ToDirections(measured.grid.Center(bin));
        ratio = Ratio(value_at(bin), model->Value(pair.wi, pair.wo), e);
      }
      for (int c = 0; c < kChannels; ++c) ratios.SetValue(c, bin, ratio[c]);
    }
  });
  const auto table = std::make_shared<const RatioTable>(std::move(ratios));
  completed.offset = e;
  completed.over_table = {table, &table->brdf};
  completed.value = [model, e, table](const DirectionPair& pair) {
    return Times(table->brdf.Interpolate(pair), model->Value(pair.wi, pair.wo), e);
  };
  return completed;
}

std::vector<CompletedMeasurement::Place> PlacesOf(const BrdfSamples& samples) {
  std::vector<CompletedMeasurement::Place> places;
  for (uint64_t k = 0; k < 4 * kPlaces && places.size() < kPlaces; ++k) {
    const int j = static_cast<int>(UniformAt(2, 2 * k) * samples.size());
    const bool directed = !samples.directions.empty();
    const DirectionPair pair =
        directed ? ToDirections(samples.directions[j]) : ToDirections(samples.Angles(j));
    if (!(UniformAt(2, 2 * k + 1) < pair.wi[2] * pair.wo[2])) continue;
    if (Mean(samples.rho[j]) > 0) places.push_back({pair, samples.rho[j]});
  }
  return places;
}

CompletedMeasurement CompleteScattered(const Measurement& scattered, const Prepared& model) {
  CompletedMeasurement completed;
  completed.places = PlacesOf(SamplesOf(scattered));
  const std::optional<HemisphereGrid> grid = GridOf(scattered);
  if (!grid) {
    completed.interpolated = false;
    completed.value = [model](const DirectionPair& pair) { return model->Value(pair.wi, pair.wo); };
    return completed;
  }
  const double e = OffsetOf(completed.places);
  NodeTable ratios = ValuesAtNodes(scattered, *grid);
  const int nodes = grid->nodes();
  for (int i = 0; i < nodes; ++i) {
    for (int o = 0; o < nodes; ++o) {
      const size_t index = static_cast<size_t>(i) * nodes + o;
      const DirectionPair pair = ToDirections(grid->Angles(i, o));
      ratios.rho[index] = ratios.present[index]
                              ? Ratio(ratios.rho[index], model->Value(pair.wi, pair.wo), e)
                              : Rgb{1, 1, 1};
      ratios.present[index] = true;
    }
  }
  completed.offset = e;
  completed.over_nodes = std::make_shared<const NodeBrdf>(std::move(ratios));
  completed.value = [model, e, brdf = completed.over_nodes](const DirectionPair& pair) {
    return Times((*brdf)(ToSphericalAngles(pair)), model->Value(pair.wi, pair.wo), e);
  };
  return completed;
}

}  // namespace

CompletedMeasurement Complete(const Measurement& measurement, const FactorModel& model,
                              int num_threads) {
  const auto prepared = std::make_shared<const PreparedModel<double>>(model);
  if (!measurement.table) return CompleteScattered(measurement, prepared);
  if (prepared->anisotropic()) {
    throw ErrorIn(ErrorKind::kUnsupported, measurement.source,
                  "a table knows no azimuths, which an anisotropic model has")
        .About("anisotropic");
  }
  return CompleteTable(*measurement.table, prepared, num_threads);
}

}  // namespace trilobe
