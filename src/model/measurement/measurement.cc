#include "trilobe/model/measurement/measurement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <utility>

#include "model/measurement/bad_readings.h"
#include "model/measurement/counter_random.h"
#include "model/measurement/largest_value.h"
#include "model/measurement/own_shadow.h"
#include "model/measurement/sample_density.h"
#include "model/measurement/unmeasured_samples.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Equal for samples that reciprocity makes equal [1e-6 rad]: the smaller theta, the larger one and
// the azimuth difference; for anisotropic data, theta and phi of the smaller and of the larger
// direction.
using ReciprocalKey = std::array<int64_t, 4>;

struct KeyedSample {
  ReciprocalKey key;
  bool swapped;  // the incident direction is the larger
  int sample;
};

KeyedSample KeyOf(const SphericalAngles& angles, bool anisotropic, int sample) {
  const auto round = [](double x) { return static_cast<int64_t>(std::llround(x * 1e6)); };
  if (anisotropic) {
    using Rounded = std::pair<int64_t, int64_t>;
    const auto rounded = [&](double theta, double phi) {
      const double turns = phi / (2 * kPi);
      const int64_t turned = round((turns - std::floor(turns)) * 2 * kPi);
      return Rounded(round(theta), round(theta) == 0 || turned == round(2 * kPi) ? 0 : turned);
    };
    const Rounded i = rounded(angles.theta_i, angles.phi_i);
    const Rounded o = rounded(angles.theta_o, angles.phi_o);
    const auto& [a, b] = std::minmax(i, o);
    return {.key = {a.first, a.second, b.first, b.second}, .swapped = i > o, .sample = sample};
  }
  const int64_t i = round(angles.theta_i), o = round(angles.theta_o);
  const double between = std::abs(std::remainder(angles.phi_o - angles.phi_i, 2 * kPi));
  return {.key = {std::min(i, o), std::max(i, o), std::min(i, o) == 0 ? 0 : round(between), 0},
          .swapped = i > o,
          .sample = sample};
}

// Sorts samples so that those of the same directions, exchanged or not, are adjacent.
std::vector<KeyedSample> ByDirections(const Measurement& scattered) {
  std::vector<KeyedSample> keys;
  keys.reserve(scattered.samples.directions.size());
  for (int j = 0; j < scattered.samples.size(); ++j) {
    keys.push_back(KeyOf(scattered.samples.directions[j], scattered.anisotropic, j));
  }
  std::ranges::stable_sort(keys, {}, &KeyedSample::key);
  return keys;
}

// In anisotropic data neighbours may be far apart; but by reciprocity, a pair of directions that
// reflects cannot be black when exchanged.
std::vector<Outlier> DeadReadings(const Measurement& scattered) {
  const std::vector<KeyedSample> keys = ByDirections(scattered);
  std::vector<Outlier> dead;
  for (size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    std::array<double, 2> brightest{};
    for (; end < keys.size() && keys[end].key == keys[begin].key; ++end) {
      double& so_far = brightest[keys[end].swapped];
      so_far = std::max(so_far, Mean(scattered.samples.rho[keys[end].sample]));
    }
    for (size_t k = begin; k < end; ++k) {
      const double exchanged = brightest[!keys[k].swapped];
      if (exchanged > 0 && !(Mean(scattered.samples.rho[keys[k].sample]) > 0)) {
        dead.push_back({.sample = keys[k].sample, .median = exchanged});
      }
    }
  }
  std::ranges::sort(dead, {}, &Outlier::sample);
  return dead;
}

constexpr double kRounding = 1e-9;  // of degrees that became radians: 60 are not beyond 60

// Keeps only these samples and counts the others as left out for this reason.
void Keep(const std::vector<int>& kept, int BinCounts::*reason, Measurement* measurement) {
  const int left_out = measurement->samples.size() - static_cast<int>(kept.size());
  if (left_out == 0) return;
  measurement->samples = Selected(measurement->samples, kept);
  measurement->counts.valid -= left_out;
  measurement->counts.*reason += left_out;
}

// Keeps all but these samples, which are in ascending order.
void KeepAllBut(const std::vector<int>& left_out, int BinCounts::*reason,
                Measurement* measurement) {
  std::vector<int> kept;
  auto next = left_out.begin();
  for (int j = 0; j < measurement->samples.size(); ++j) {
    if (next != left_out.end() && *next == j) {
      ++next;
    } else {
      kept.push_back(j);
    }
  }
  Keep(kept, reason, measurement);
}

}  // namespace

BrdfSamples SamplesOf(const Measurement& measurement) {
  if (measurement.table) return ValidSamples(*measurement.table);
  if (measurement.samples.size() == 0) {
    throw ErrorIn(
        ErrorKind::kData, measurement.source,
        "no valid sample of " + std::to_string(measurement.counts.total) +
            std::string(
                ": nowhere are both directions above the surface and all values finite and >= 0, "
                "within --max_angle and --min_theta_d; trilobe info counts why") +
            (2.0 * measurement.counts.negative > measurement.counts.total
                 ? "; most are negative, as decibels and logarithms are, which --columns calls db, "
                   "log10 or ln"
                 : ""))
        .About("samples", 0);
  }
  BrdfSamples samples = measurement.samples;
  if (!measurement.anisotropic) EvenOutDensity(&samples);
  return samples;
}

const BrdfTable& TableOf(const Measurement& measurement) {
  if (measurement.table) return *measurement.table;
  throw ErrorIn(ErrorKind::kUnsupported, measurement.source,
                "this command needs a table on the MERL grid, and this is a " + measurement.kind +
                    "; take a MERL or RGL file, or synth:NAME")
      .About("table");
}

BrdfTable TableOf(Measurement&& measurement) {
  TableOf(std::as_const(measurement));
  return *std::move(measurement.table);
}

BinCounts CountsOf(const Measurement& measurement) {
  return measurement.table ? CountBins(*measurement.table) : measurement.counts;
}

double MaxAngleDegrees(const Measurement& measurement) {
  return MaxAngleDegrees(measurement.table ? measurement.table->max_theta : measurement.max_theta);
}

void CheckDirections(const Measurement& scattered) {
  const BrdfSamples& samples = scattered.samples;
  if (samples.directions.size() == samples.rho.size() &&
      samples.angles.size() == samples.rho.size()) {
    return;
  }
  throw ErrorIn(ErrorKind::kMismatch, scattered.source,
                std::to_string(samples.size()) + " scattered samples have " +
                    std::to_string(samples.directions.size()) + " pairs of directions and " +
                    std::to_string(samples.angles.size()) + " angles; each needs one")
      .About("directions", samples.directions.size());
}

void LimitAngles(double max_theta, Measurement* measurement) {
  if (NotNull(measurement, "the measurement").table) {
    LimitAngles(max_theta, Unmeasured::kBeyondMaxAngle, &*measurement->table);
    return;
  }
  if (!(max_theta >= 0)) {
    throw Error(ErrorKind::kRange, "the largest angle must be a number of 0 or more")
        .About("max_theta", max_theta);
  }
  CheckDirections(*measurement);
  const double largest = std::min(max_theta, measurement->max_theta);
  std::vector<int> kept;
  measurement->max_theta = 0;
  for (int j = 0; j < measurement->samples.size(); ++j) {
    const SphericalAngles& at = measurement->samples.directions[j];
    const double theta = std::max(at.theta_i, at.theta_o);
    if (theta > largest + kRounding) continue;
    kept.push_back(j);
    measurement->max_theta = std::max(measurement->max_theta, std::min(theta, largest));
  }
  Keep(kept, &BinCounts::beyond_max_angle, measurement);
}

void LimitThetaD(double min_theta_d, Measurement* measurement) {
  if (NotNull(measurement, "the measurement").table) {
    LimitThetaD(min_theta_d, &*measurement->table);
    return;
  }
  if (std::isnan(min_theta_d)) {
    throw Error(ErrorKind::kRange, "the smallest theta_d must be a number")
        .About("min_theta_d", min_theta_d);
  }
  CheckDirections(*measurement);
  std::vector<int> kept;
  for (int j = 0; j < measurement->samples.size(); ++j) {
    if (measurement->samples.Angles(j).theta_d >= min_theta_d - kRounding) kept.push_back(j);
  }
  Keep(kept, &BinCounts::below_min_theta_d, measurement);
}

void LeaveOutOwnShadow(Measurement* measurement) {
  if (NotNull(measurement, "the measurement").table) return;
  CheckDirections(*measurement);
  const OwnShadow shadow = FindOwnShadow(measurement->samples);
  if (shadow.theta_d_deg == 0) return;
  LimitThetaD(DegreesToRadians(shadow.theta_d_deg), measurement);
  std::ostringstream note;
  note << "the highlight is " << std::lround(shadow.darker)
       << " times darker towards theta_d = 0 than at 20 to 30 deg, as where a detector stands in "
          "its own light: "
       << measurement->counts.below_min_theta_d << " samples below "
       << static_cast<int>(shadow.theta_d_deg) << " deg are left out; --min_theta_d=0 takes them";
  measurement->notes.push_back(note.str());
}

void LeaveOutFill(Measurement* measurement) {
  if (NotNull(measurement, "the measurement").table || measurement->anisotropic) return;
  CheckDirections(*measurement);
  const FilledSamples filled = FindFilled(measurement->samples);
  if (filled.samples.empty()) return;
  KeepAllBut(filled.samples, &BinCounts::extrapolated, measurement);
  measurement->notes.push_back(
      std::to_string(filled.theta_i) + " of " + std::to_string(filled.all_theta_i) +
      " theta_i and " + std::to_string(filled.theta_o) + " of " +
      std::to_string(filled.all_theta_o) +
      " theta_o repeat, to the bit, the values of the one before: " +
      std::to_string(filled.samples.size()) +
      " samples seem to be filled in, not measured, and are left out; --extrapolated takes them");
}

void LeaveOutMarks(Measurement* measurement) {
  if (NotNull(measurement, "the measurement").table) return;
  CheckDirections(*measurement);
  const BrdfSamples& samples = measurement->samples;
  const LargestValueSymptom largest = LargestValueOf(samples);
  if (!largest.IsMark(samples.size())) return;
  std::vector<int> marks;
  for (int j = 0; j < samples.size(); ++j) {
    if (HasLargest(largest, samples, j)) marks.push_back(j);
  }
  KeepAllBut(marks, &BinCounts::missing, measurement);
  measurement->notes.push_back(MarkText(largest) + ", and is left out; --outliers takes it");
}

void LeaveOutZeroGaps(Measurement* measurement) {
  if (NotNull(measurement, "the measurement").table || measurement->anisotropic) return;
  CheckDirections(*measurement);
  const std::vector<int> gaps = FindZeroGaps(measurement->samples);
  if (gaps.empty()) return;
  const int valid = measurement->samples.size();
  KeepAllBut(gaps, &BinCounts::missing, measurement);
  measurement->notes.push_back(
      std::to_string(gaps.size()) + " of " + std::to_string(valid) +
      " samples are 0 beside others that are not dark, as where nothing was measured, and left "
      "out; --outliers takes them");
}

void SmoothDarkReadings(int num_threads, Measurement* measurement) {
  if (!NotNull(measurement, "the measurement").table) return;
  const int valid = CountsOf(*measurement).valid;
  const int smoothed = SmoothDarkReadings(num_threads, &*measurement->table);
  if (smoothed == 0) return;
  measurement->notes.push_back(
      "dark noise is more than a tenth of " + std::to_string(smoothed) + " of " +
      std::to_string(valid) +
      " readings, which became medians of those around them; --dark_noise takes them as they are");
}

void LeaveOutOutliers(int num_threads, Measurement* measurement) {
  const int valid = CountsOf(NotNull(measurement, "the measurement")).valid;
  if (valid == 0) return;
  constexpr int kFewest = 10;
  constexpr double kLeastLight = 2e-5;
  const int least = measurement->table ? kFewest : std::max(kFewest, valid / 500);
  const std::optional<BrdfSamples> of_table =
      measurement->table ? std::optional(SamplesOf(*measurement)) : std::nullopt;
  const BrdfSamples& samples = of_table ? *of_table : measurement->samples;
  std::vector<Outlier> outliers =
      measurement->anisotropic ? DeadReadings(*measurement) : FindOutliers(samples, num_threads);
  const auto is_near = [](const Outlier& outlier) { return !outlier.far; };
  const int fewest_near = std::max(kFewest, valid / 500);
  if (std::ranges::count_if(outliers, is_near) < fewest_near) std::erase_if(outliers, is_near);
  const int count = static_cast<int>(outliers.size());
  if (count < least || LightOf(outliers, samples) < kLeastLight) return;
  if (measurement->table) {
    for (const Outlier& outlier : outliers) {
      for (auto& plane : measurement->table->stored) plane[samples.bins[outlier.sample]] = -1;
    }
  } else {
    std::vector<int> numbers;
    for (const Outlier& outlier : outliers) numbers.push_back(outlier.sample);
    KeepAllBut(numbers, &BinCounts::negative, measurement);
  }
  measurement->notes.push_back(
      std::to_string(count) + " of " + std::to_string(valid) +
      (measurement->anisotropic
           ? " samples are 0 where those with wi and wo exchanged are not, as dead readings are"
           : " samples are much darker or brighter than those around them, as dead readings and "
             "glints are") +
      ", and left out; --outliers takes them");
}

void LeaveOutAtRandom(double share, uint64_t seed, Measurement* measurement) {
  NotNull(measurement, "the measurement");
  if (share == 0) return;
  if (!(share > 0 && share < 1)) {
    throw Error(ErrorKind::kRange, "the share of missing directions is " + std::to_string(share) +
                                       "; it must be from 0 up to 1")
        .About("missing", share);
  }
  // Different from the random numbers of noise with the same seed.
  const auto is_lost = [&](uint64_t k) { return UniformAt(~seed, k) < share; };
  if (measurement->table) {
    BrdfTable& table = *measurement->table;
    const std::vector<bool> valid = ValidBins(table);
    for (int bin = 0; bin < table.grid.size(); ++bin) {
      for (int c = 0; c < kChannels && valid[bin] && is_lost(bin); ++c) table.stored[c][bin] = -1;
    }
    return;
  }
  CheckDirections(*measurement);
  std::vector<int> kept;
  for (int j = 0; j < measurement->samples.size(); ++j) {
    if (!is_lost(j)) kept.push_back(j);
  }
  Keep(kept, &BinCounts::missing, measurement);
}

void TurnAzimuths(Measurement* scattered) {
  NotNull(scattered, "the measurement");
  CheckDirections(*scattered);
  BrdfSamples& samples = scattered->samples;
  for (int j = 0; j < samples.size(); ++j) {
    samples.directions[j].phi_o += kPi;
    samples.angles[j] = ToHalfDiff(ToDirections(samples.directions[j]));
  }
  scattered->look_up = nullptr;
  scattered->formula = nullptr;
}

PairError ReciprocityError(const Measurement& scattered) {
  CheckDirections(scattered);
  const std::vector<KeyedSample> keys = ByDirections(scattered);
  std::vector<std::pair<Rgb, Rgb>> pairs;
  for (size_t begin = 0, end = 0; begin < keys.size(); begin = end) {
    std::array<Rgb, 2> mean{};
    std::array<int, 2> count{};
    for (; end < keys.size() && keys[end].key == keys[begin].key; ++end) {
      const Rgb& rho = scattered.samples.rho[keys[end].sample];
      const bool side = keys[end].swapped;
      ++count[side];
      for (int c = 0; c < kChannels; ++c) mean[side][c] += (rho[c] - mean[side][c]) / count[side];
    }
    if (count[0] == 0 || count[1] == 0) continue;
    pairs.emplace_back(mean[0], mean[1]);
  }
  return ErrorOfPairs(pairs);
}

SampleCollector::SampleCollector(const std::string& source, const std::string& kind) {
  measurement_.source = source;
  measurement_.kind = kind;
  measurement_.samples.source = source;
  measurement_.max_theta = 0;
}

bool SampleCollector::Add(const SphericalAngles& angles, const Rgb& rho) {
  // The horizon counts as below the surface, too; users of the samples test cosines computed from
  // the half and difference angles, which are no others far from it.
  constexpr double kFarFromHorizon = kPi / 2 - 1e-6;
  const double larger = std::max(angles.theta_i, angles.theta_o);
  const HalfDiffAngles half_diff =
      larger < kPi / 2 ? ToHalfDiff(DirectionsOf(angles)) : HalfDiffAngles{};
  const auto is_above = [&] {
    const Cosines cosines = ToCosines(half_diff);
    return larger < kPi / 2 && cosines.i > 0 && cosines.o > 0;
  };
  if (!(larger < kFarFromHorizon && IsAboveSurface(angles)) && !is_above()) {
    LeaveOut(&BinCounts::below_surface);
  } else if (!std::ranges::all_of(rho, [](double x) { return std::isfinite(x); })) {
    LeaveOut(&BinCounts::non_finite);
  } else if (std::ranges::any_of(rho, [](double x) { return x < 0; })) {
    LeaveOut(&BinCounts::negative);
  } else {
    ++measurement_.counts.total;
    ++measurement_.counts.valid;
    measurement_.samples.angles.push_back(half_diff);
    measurement_.samples.rho.push_back(rho);
    measurement_.samples.directions.push_back(angles);
    measurement_.max_theta = std::max({measurement_.max_theta, angles.theta_i, angles.theta_o});
    return true;
  }
  return false;
}

DirectionPair SampleCollector::DirectionsOf(const SphericalAngles& angles) {
  const PolarAngles at_i = {angles.theta_i, angles.phi_i}, at_o = {angles.theta_o, angles.phi_o};
  if (at_i != last_i_) last_.wi = ToDirection(last_i_ = at_i);
  if (at_o != last_o_) last_.wo = ToDirection(last_o_ = at_o);
  return last_;
}

bool SampleCollector::AddColor(const SphericalAngles& angles, const Rgb& rho) {
  Rgb clipped = rho;
  for (double& x : clipped) x = x < 0 ? 0 : x;
  const bool valid = Add(angles, clipped);
  if (valid && clipped != rho) ++measurement_.out_of_gamut;
  return valid;
}

void SampleCollector::KeepSpectrum(std::span<const double> wavelengths,
                                   std::span<const double> spectrum) {
  if (spectra_.wavelengths.empty()) {
    spectra_.wavelengths.assign(wavelengths.begin(), wavelengths.end());
  }
  spectra_.values.insert(spectra_.values.end(), spectrum.begin(), spectrum.end());
}

void SampleCollector::LeaveOut(int BinCounts::*reason) {
  if (reason == nullptr) {
    throw Error(ErrorKind::kMissing, "a sample is left out for a reason, not null").About("reason");
  }
  ++measurement_.counts.total;
  ++(measurement_.counts.*reason);
}

Measurement SampleCollector::Take() {
  BrdfSamples& samples = measurement_.samples;
  samples.angles.shrink_to_fit();
  samples.rho.shrink_to_fit();
  samples.directions.shrink_to_fit();
  spectra_.values.shrink_to_fit();
  if (!spectra_.values.empty()) samples.SetSpectra(std::move(spectra_));
  return std::move(measurement_);
}

Measurement SampleCollector::TakeByAzimuths() {
  constexpr double kSame = 1e-6;  // [rad]
  const SphericalAngles* first = nullptr;
  for (const SphericalAngles& at : measurement_.samples.directions) {
    if (at.theta_i < kSame) continue;
    if (first == nullptr) first = &at;
    if (std::abs(std::remainder(at.phi_i - first->phi_i, 2 * kPi)) > kSame) {
      measurement_.anisotropic = true;
      break;
    }
  }
  return Take();
}

}  // namespace trilobe
