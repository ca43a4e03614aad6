#include "model/measurement/corrupted_readings.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/base/quantile.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {
namespace {

bool IsAbove(const DirectionPair& pair) { return pair.wi[2] > 0 && pair.wo[2] > 0; }

// The pair turned about the normal, so that phi_i is 0.
DirectionPair WithLightAtAzimuthZero(const DirectionPair& pair) {
  const double length = std::hypot(pair.wi[0], pair.wi[1]);
  if (length == 0) return pair;
  const double c = pair.wi[0] / length, s = pair.wi[1] / length;
  const auto turn = [&](const Direction& w) {
    return Direction{c * w[0] + s * w[1], c * w[1] - s * w[0], w[2]};
  };
  return {turn(pair.wi), turn(pair.wo)};
}

}  // namespace

Readings::Readings(Measurement* measurement, int num_threads)
    : measurement_(*measurement), num_threads_(num_threads) {
  if (table()) {
    BrdfSamples samples = ValidSamples(*measurement_.table);
    bins_ = std::move(samples.bins);
    rho_ = std::move(samples.rho);
  } else {
    CheckDirections(measurement_);
    rho_ = SamplesOf(measurement_).rho;
  }
  lost_.assign(rho_.size(), 0);
}

DirectionPair Readings::Directions(int j) const {
  return table() ? WithLightAtAzimuthZero(ToDirections(measurement_.table->grid.Center(bins_[j])))
                 : ToDirections(measurement_.samples.directions[j]);
}

Cosines Readings::CosinesOf(int j) const {
  return table() ? ToCosines(measurement_.table->grid.Center(bins_[j]))
                 : measurement_.samples.CosinesOf(j);
}

double Readings::ThetaD(int j) const {
  return table() ? measurement_.table->grid.Center(bins_[j]).theta_d
                 : measurement_.samples.angles[j].theta_d;
}

double Readings::MedianSignal() const {
  std::vector<double> signals(size());
  ForEach([&](int j) { signals[j] = Mean(rho_[j]) * CosinesOf(j).i; });
  return Quantile(&signals, 0.5);
}

double Readings::LargestSignal() const {
  double largest = 0;
  for (int j = 0; j < size(); ++j) {
    largest = std::max(largest, std::ranges::max(rho_[j]) * CosinesOf(j).i);
  }
  return largest;
}

Readings::Between Readings::ReadBetween() const {
  BrdfFunction rho;
  if (table()) {
    const auto table = std::make_shared<const TabulatedBrdf>(*measurement_.table);
    rho = [table](const DirectionPair& pair) { return table->Interpolate(pair); };
  } else if (measurement_.look_up) {
    rho = [&from = measurement_.look_up](const DirectionPair& pair) { return from(pair).rho; };
  } else if (measurement_.formula) {
    rho = measurement_.formula;
  } else {
    throw ErrorIn(
        ErrorKind::kUnsupported, measurement_.source,
        "--tilt and the corruptions tilt, origin, aperture and repeat read between samples, "
        "which a table, an RGL file and a synthetic material allow before any other kind "
        "has changed them, and scattered samples do not: leave them out")
        .About("tilt");
  }
  return [rho](const DirectionPair& pair) {
    return IsAbove(pair) ? std::optional(rho(pair)) : std::nullopt;
  };
}

void Readings::ForEach(const std::function<void(int)>& work) const {
  ParallelForShort(size(), num_threads_, work);
}

// Spectra become as much brighter as their colours do.
void Readings::ScaleSpectra() {
  BrdfSamples& samples = measurement_.samples;
  if (samples.spectra == nullptr || rho_ == samples.rho) return;
  Spectra scaled = {samples.spectra->wavelengths, {}};
  for (int j = 0; j < size(); ++j) {
    const double before = Mean(samples.rho[j]);
    const double ratio = before > 0 && !lost(j) ? Mean(rho_[j]) / before : 1;
    for (const double value : samples.SpectrumOf(j)) scaled.values.push_back(ratio * value);
  }
  samples.SetSpectra(std::move(scaled));
}

void Readings::Store() {
  const auto is_valid = [](double x) { return x >= 0 && std::isfinite(x); };
  std::vector<int> kept;
  for (int j = 0; j < size(); ++j) {
    if (!std::ranges::all_of(rho_[j], is_valid)) Lose(j);
    if (!lost(j)) kept.push_back(j);
  }
  if (table()) {
    for (int j = 0; j < size(); ++j) {
      for (int c = 0; c < kChannels; ++c) {
        BrdfTable& table = *measurement_.table;
        if (lost(j)) {
          table.stored[c][bins_[j]] = -1;
        } else if (rho_[j][c] != table.Value(c, bins_[j])) {  // else to the bit as it was
          table.SetValue(c, bins_[j], rho_[j][c]);
        }
      }
    }
    return;
  }
  const int lost = size() - static_cast<int>(kept.size());
  ScaleSpectra();
  measurement_.samples.rho = std::move(rho_);
  measurement_.samples = Selected(measurement_.samples, kept);
  measurement_.max_theta = 0;
  for (const SphericalAngles& at : measurement_.samples.directions) {
    measurement_.max_theta = std::max({measurement_.max_theta, at.theta_i, at.theta_o});
  }
  measurement_.counts.valid -= lost;
  measurement_.counts.missing += lost;
}

}  // namespace trilobe
