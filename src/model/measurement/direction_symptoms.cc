#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "core/base/grid_cosines.h"
#include "core/base/quantile.h"
#include "model/measurement/sample_symptoms.h"
#include "model/measurement/symptoms.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

// Symptoms in how values change with the directions.
namespace trilobe {
namespace {

double MeanOfBin(const BrdfTable& table, int bin) {
  return Mean({table.Value(0, bin), table.Value(1, bin), table.Value(2, bin)});
}

// A bin and its exchanged one, both above 0, with very different cosines.
struct ExchangedPair {
  Cosines cosines;       // of the first
  double first, second;  // means over the channels
  double LogRatio() const { return std::log(first / second); }
};

constexpr size_t kFewestPairs = 100;

std::vector<ExchangedPair> ExchangedPairsOf(const BrdfTable& table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  const GridCosines cosines(grid);
  std::vector<ExchangedPair> pairs;
  constexpr double kApart = 1.5;
  for (int h = 0; h < grid.theta_h; h += 2) {
    for (int d = h % 3; d < grid.theta_d; d += 3) {
      for (int p = 0; p < grid.phi_d / 2; ++p) {
        const int a = grid.Index(h, d, p), b = grid.Index(h, d, grid.phi_d - 1 - p);
        if (!valid[a] || !valid[b]) continue;
        const ExchangedPair pair = {cosines(h, d, p), MeanOfBin(table, a), MeanOfBin(table, b)};
        if (!(std::abs(std::log(pair.cosines.i / pair.cosines.o)) > std::log(kApart))) continue;
        if (pair.first > 0 && pair.second > 0) pairs.push_back(pair);
      }
    }
  }
  return pairs;
}

// The median of a number over pairs.
template <typename Number>
double MedianOf(const std::vector<ExchangedPair>& pairs, const Number& number) {
  std::vector<double> numbers(pairs.size());
  std::ranges::transform(pairs, numbers.begin(), number);
  return Quantile(&numbers, 0.5);
}

double ErrorOf(const std::vector<ExchangedPair>& pairs) {
  return MedianOf(pairs, [](const ExchangedPair& pair) { return std::abs(pair.LogRatio()); });
}

// Over a subset of the valid bins, of which there is at least one.
double MedianSignalOf(const BrdfTable& table) {
  const std::vector<bool> valid = ValidBins(table);
  const GridCosines cosines(table.grid);
  std::vector<double> signals;
  const int stride = table.grid.phi_d + 1;  // visits all phi_d
  for (int skipped = 0; skipped < stride && signals.size() < kFewestPairs; ++skipped) {
    for (int bin = skipped; bin < table.grid.size(); bin += stride) {
      if (valid[bin]) signals.push_back(MeanOfBin(table, bin) * cosines(bin).i);
    }
  }
  return Quantile(&signals, 0.5);
}

}  // namespace

CosineSymptom CosineOf(const BrdfTable& table) {
  const std::vector<ExchangedPair> pairs = ExchangedPairsOf(table);
  if (pairs.size() < kFewestPairs) return {};
  const auto apart = [](const ExchangedPair& pair) {
    return std::log(pair.cosines.i / pair.cosines.o);
  };
  CosineSymptom symptom{
      .is_decided = true,
      .exponent = MedianOf(pairs, [&](const auto& pair) { return pair.LogRatio() / apart(pair); }),
      .error = ErrorOf(pairs)};
  const double nearer = symptom.exponent > 0 ? 1 : -1;
  symptom.error_without = MedianOf(
      pairs, [&](const auto& pair) { return std::abs(pair.LogRatio() - nearer * apart(pair)); });
  return symptom;
}

StrayLightSymptom StrayLightOf(const BrdfTable& table) {
  const std::vector<ExchangedPair> pairs = ExchangedPairsOf(table);
  if (pairs.size() < kFewestPairs) return {};
  const double signal = MedianSignalOf(table);
  if (!(signal > 0)) return {};
  const double light = MedianOf(pairs, [](const ExchangedPair& pair) {
    return (pair.first - pair.second) / (1 / pair.cosines.i - 1 / pair.cosines.o);
  });
  const auto error_without = [light](const ExchangedPair& pair) {
    const double first = pair.first - light / pair.cosines.i;
    const double second = pair.second - light / pair.cosines.o;
    return first > 0 && second > 0 ? std::abs(std::log(first / second))
                                   : std::numeric_limits<double>::infinity();
  };
  return {.share = light / signal,
          .error = ErrorOf(pairs),
          .error_without = MedianOf(pairs, error_without)};
}

namespace {

// wi and wo in the frame whose x axis lies under wi, mirrored to wo[1] >= 0.
DirectionPair Folded(double theta_i, double theta_o, double azimuth) {
  return ToDirections(SphericalAngles{
      .theta_i = theta_i, .phi_i = 0, .theta_o = theta_o, .phi_o = std::abs(azimuth)});
}

struct ExchangedSamples {
  double log_ratio = 0;    // of the values
  double log_cosines = 0;  // of cos theta_i / cos theta_o of the first
};

std::vector<ExchangedSamples> ExchangedSamplesOf(const BrdfSamples& samples) {
  constexpr double kApart = 1.5;
  constexpr int kMost = 3000;  // pairs are looked for among all of these
  const double least_cosine = std::cos(DegreesToRadians(4));
  const BrdfSamples some = EvenlySpread(samples, kMost);
  std::vector<DirectionPair> pairs(some.size()), exchanged(some.size());
  for (int j = 0; j < some.size(); ++j) {
    const SphericalAngles& at = some.directions[j];
    pairs[j] = Folded(at.theta_i, at.theta_o, AzimuthFromLight(at));
    exchanged[j] = Folded(at.theta_o, at.theta_i, AzimuthFromLight(at));
  }
  std::vector<ExchangedSamples> found;
  for (int j = 0; j < some.size(); ++j) {
    const double log_cosines = std::log(pairs[j].wi[2] / pairs[j].wo[2]);
    const double first = Mean(some.rho[j]);
    if (!(log_cosines > std::log(kApart) && first > 0)) continue;
    double nearest = least_cosine;
    int partner = -1;
    for (int k = 0; k < some.size(); ++k) {
      const double near =
          std::min(Dot(exchanged[j].wi, pairs[k].wi), Dot(exchanged[j].wo, pairs[k].wo));
      if (near > nearest) {
        nearest = near;
        partner = k;
      }
    }
    const double second = partner < 0 ? 0 : Mean(some.rho[partner]);
    if (second > 0) found.push_back({std::log(first / second), log_cosines});
  }
  return found;
}

template <typename Number>
double MedianOverPairs(const std::vector<ExchangedSamples>& pairs, const Number& number) {
  std::vector<double> numbers(pairs.size());
  std::ranges::transform(pairs, numbers.begin(), number);
  return Quantile(&numbers, 0.5);
}

}  // namespace

CosineSymptom CosineOf(const BrdfSamples& samples) {
  constexpr size_t kFewestOfSamples = 20;
  const std::vector<ExchangedSamples> pairs = ExchangedSamplesOf(samples);
  if (pairs.size() < kFewestOfSamples) return {};
  CosineSymptom symptom{
      .is_decided = true,
      .exponent = MedianOverPairs(
          pairs, [](const auto& pair) { return pair.log_ratio / pair.log_cosines; }),
      .error = MedianOverPairs(pairs, [](const auto& pair) { return std::abs(pair.log_ratio); })};
  const double nearer = symptom.exponent > 0 ? 1 : -1;
  symptom.error_without = MedianOverPairs(pairs, [&](const auto& pair) {
    return std::abs(pair.log_ratio - nearer * pair.log_cosines);
  });
  return symptom;
}

RepetitionSymptom RepetitionOf(const BrdfTable& table) {
  constexpr int kFirst = 40, kStep = 2, kSteps = 24;  // of theta_i [deg]
  constexpr size_t kFewest = 20;                      // pairs of neighbours that tell of a step
  const std::vector<bool> valid = ValidBins(table);
  if (std::ranges::find(valid, true) == valid.end()) return {};
  const TabulatedBrdf brdf(table);
  // The change of values from one theta_i to the next, median over the other angles.
  std::vector<double> changes;
  for (int k = 0; k < kSteps; ++k) {
    std::vector<double> of_step;
    for (int theta_o = 10; theta_o <= 45; theta_o += 5) {
      for (int phi = 20; phi < 180; phi += 20) {
        const auto value = [&](int theta_i) {
          const HalfDiffAngles at = ToHalfDiff(ToDirections({.theta_i = DegreesToRadians(theta_i),
                                                             .phi_i = 0,
                                                             .theta_o = DegreesToRadians(theta_o),
                                                             .phi_o = DegreesToRadians(phi)}));
          return valid[table.grid.Bin(at)] ? Mean(brdf.Interpolate(at)) : 0;
        };
        const double first = value(kFirst + k * kStep), second = value(kFirst + (k + 1) * kStep);
        if (first > 0 && second > 0) of_step.push_back(std::abs(std::log(second / first)));
      }
    }
    if (of_step.size() < kFewest) break;
    changes.push_back(Quantile(&of_step, 0.5));
  }
  constexpr size_t kFewestRepeated = 3, kBefore = 5;
  constexpr double kLess = 0.1;
  for (size_t begin = kBefore + 1; begin + kFewestRepeated <= changes.size(); ++begin) {
    // Without step begin - 1, which starts before the angle.
    std::vector<double> before(changes.begin() + static_cast<std::ptrdiff_t>(begin - kBefore - 1),
                               changes.begin() + static_cast<std::ptrdiff_t>(begin - 1));
    const double most =
        *std::max_element(changes.begin() + static_cast<std::ptrdiff_t>(begin), changes.end());
    if (most < kLess * Quantile(&before, 0.5)) {
      return {.degrees = static_cast<double>(kFirst + kStep * static_cast<int>(begin))};
    }
  }
  return {};
}

TiltSymptom TiltOf(const BrdfTable& table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  const double within = DegreesToRadians(15);
  std::vector<double> middles;
  for (int d = 0; d < grid.theta_d; ++d) {
    const double theta_d = grid.ThetaD(d + 0.5);
    if (theta_d < DegreesToRadians(10) || theta_d > DegreesToRadians(60)) continue;
    double largest = 0;
    for (int h = 0; h < grid.theta_h && grid.ThetaH(h + 0.5) < within; ++h) {
      for (int p = 0; p < grid.phi_d; ++p) {
        const int bin = grid.Index(h, d, p);
        if (valid[bin]) largest = std::max(largest, MeanOfBin(table, bin));
      }
    }
    double light = 0, along = 0, rim = 0;
    int at_rim = 0;
    for (int h = 0; h < grid.theta_h && grid.ThetaH(h + 0.5) < within; ++h) {
      const bool last = !(grid.ThetaH(h + 1.5) < within);
      const double area = grid.ThetaH(h + 0.5) * (grid.ThetaH(h + 1) - grid.ThetaH(h));
      for (int p = 0; p < grid.phi_d; ++p) {
        const int bin = grid.Index(h, d, p);
        if (!valid[bin]) continue;
        const double rho = MeanOfBin(table, bin);
        if (last) {
          rim += rho;
          ++at_rim;
        }
        const double above = std::max(rho - largest / 2, 0.0) * area;
        light += above;
        // wi is at phi_d from the azimuth of h.
        const HalfDiffAngles at = grid.Center(bin);
        along += above * at.theta_h * std::cos(at.phi_d);
      }
    }
    // A highlight rather than diffuse light.
    if (!(light > 0 && at_rim > 0 && rim / at_rim < largest / 3)) continue;
    middles.push_back(RadiansToDegrees(along / light));
  }
  constexpr size_t kFewest = 10;
  if (middles.size() < kFewest) return {};
  return {.highlight = true,
          .degrees = Quantile(&middles, 0.5),
          .spread = Quantile(&middles, 0.75) - Quantile(&middles, 0.25)};
}

namespace {

// Whether samples near the mirror direction were measured, and are much darker than the brightest.
bool MirrorSideIsDark(const BrdfSamples& samples, const std::vector<int>& numbers, double largest) {
  constexpr double kNear = 10, kAcross = 30;  // degrees
  constexpr double kDarker = 3;
  bool measured = false;
  for (const int j : numbers) {
    const SphericalAngles& at = samples.directions[j];
    const double azimuth = std::abs(AzimuthFromLight(at));
    if (std::abs(at.theta_o - at.theta_i) > DegreesToRadians(kNear)) continue;
    if (azimuth < kPi - DegreesToRadians(kAcross)) continue;
    measured = true;
    if (kDarker * Mean(samples.rho[j]) > largest) return false;
  }
  return measured;
}

}  // namespace

HighlightSymptom HighlightOf(const BrdfSamples& samples) {
  constexpr double kBrighter = 3, kStrong = 10;
  constexpr size_t kFewest = 8;
  HighlightSymptom symptom;
  for (const auto& [step, numbers] : ByIncidence(samples)) {
    if (numbers.size() < kFewest) continue;
    std::vector<double> values;
    for (const int j : numbers) values.push_back(Mean(samples.rho[j]));
    const int brightest = numbers[std::ranges::max_element(values) - values.begin()];
    const SphericalAngles& at = samples.directions[brightest];
    const double largest = Mean(samples.rho[brightest]);
    if (at.theta_i < DegreesToRadians(20) || !(largest > kBrighter * Quantile(&values, 0.5))) {
      continue;
    }
    ++symptom.incidences;
    symptom.is_strong =
        largest > kStrong * Quantile(&values, 0.5) && MirrorSideIsDark(samples, numbers, largest);
    symptom.at_normal += at.theta_o < at.theta_i / 2 ? 1 : 0;
    symptom.at_light +=
        at.theta_o > DegreesToRadians(10) && std::abs(AzimuthFromLight(at)) < DegreesToRadians(30)
            ? 1
            : 0;
  }
  return symptom;
}

namespace {

double LogarithmicSpread(std::vector<double>* logarithms) {
  return Quantile(logarithms, 0.9) - Quantile(logarithms, 0.1);
}

}  // namespace

namespace {

// The spread of values at theta_o = 0 with the azimuth, median over the incidences: they are of one
// direction, the normal, unless that angle is counted from elsewhere. Below 0 if there is none.
double SpreadAtNormal(const BrdfSamples& samples) {
  constexpr double kNormal = 0.005, kSame = 1e-4;  // [rad]
  constexpr size_t kFewest = 4, kFewestIncidences = 2;
  std::map<std::pair<int64_t, int64_t>, std::vector<double>> incidences;
  for (int j = 0; j < samples.size(); ++j) {
    const SphericalAngles& at = samples.directions[j];
    const double mean = Mean(samples.rho[j]);
    if (at.theta_o > kNormal || at.theta_i < DegreesToRadians(10) || !(mean > 0)) continue;
    incidences[{std::llround(at.theta_i / kSame), std::llround(at.phi_i / kSame)}].push_back(
        std::log(mean));
  }
  std::vector<double> spreads;
  for (auto& [light, logarithms] : incidences) {
    if (logarithms.size() >= kFewest) spreads.push_back(LogarithmicSpread(&logarithms));
  }
  return spreads.size() < kFewestIncidences ? -1 : UpperMedian(std::move(spreads));
}

struct LogValue {
  HalfDiffAngles at;
  double log = 0;
};

// Variance of log rho within bins of theta_h, and in each of theta_d, that hold as many samples
// each: what a function of the two leaves of it.
double VarianceInBins(std::vector<LogValue> values) {
  constexpr size_t kHalf = 8, kDifference = 3;
  const auto bin_of = [](std::span<LogValue> all, size_t bin, size_t bins) {
    const size_t begin = bin * all.size() / bins, end = (bin + 1) * all.size() / bins;
    return all.subspan(begin, end - begin);
  };
  std::ranges::sort(values, {}, [](const LogValue& one) { return one.at.theta_h; });
  double left = 0;
  for (size_t h = 0; h < kHalf; ++h) {
    const std::span<LogValue> row = bin_of(values, h, kHalf);
    std::ranges::sort(row, {}, [](const LogValue& one) { return one.at.theta_d; });
    for (size_t d = 0; d < kDifference; ++d) {
      const std::span<LogValue> bin = bin_of(row, d, kDifference);
      double mean = 0;
      for (const LogValue& one : bin) mean += one.log / static_cast<double>(bin.size());
      for (const LogValue& one : bin) left += std::pow(one.log - mean, 2);
    }
  }
  return left / static_cast<double>(values.size());
}

}  // namespace

ElevationSymptom ElevationsOf(const BrdfSamples& samples) {
  constexpr size_t kFewest = 48;
  const double least = DegreesToRadians(1), most = kPi / 2 - least;
  std::vector<LogValue> as_read, as_elevations;
  for (int j = 0; j < samples.size(); ++j) {
    SphericalAngles at = samples.directions[j];
    const double mean = Mean(samples.rho[j]);
    if (std::min(at.theta_i, at.theta_o) < least || std::max(at.theta_i, at.theta_o) > most) {
      continue;
    }
    if (!(mean > 0)) continue;
    as_read.push_back({samples.angles[j], std::log(mean)});
    at.theta_i = kPi / 2 - at.theta_i;
    at.theta_o = kPi / 2 - at.theta_o;
    as_elevations.push_back({ToHalfDiff(ToDirections(at)), std::log(mean)});
  }
  ElevationSymptom symptom = {.at_normal = SpreadAtNormal(samples)};
  if (as_read.size() >= kFewest) {
    symptom.as_read = VarianceInBins(std::move(as_read));
    symptom.as_elevations = VarianceInBins(std::move(as_elevations));
  }
  return symptom;
}

}  // namespace trilobe
