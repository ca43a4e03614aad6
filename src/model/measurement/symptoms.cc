#include "model/measurement/symptoms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include "core/base/grid_cosines.h"
#include "core/base/quantile.h"
#include "model/measurement/own_shadow.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {
namespace {

constexpr double kEqual = 1e-9;  // relative

// "5.8 %", "96 %".
std::string Percent(double share) {
  std::ostringstream text;
  const double percent = 100 * share;
  text.precision(2);
  if (percent < 10) {
    text << percent;
  } else {
    text << std::lround(percent);
  }
  return text.str() + " %";
}

}  // namespace

PlateauSymptom PlateauOf(const BrdfTable& table) {
  const std::vector<bool> valid = ValidBins(table);
  const GridCosines cosines(table.grid);
  struct Largest {
    double value = 0;
    int count = 0, rows = 0, last_row = -1;
    void Add(double x, int row) {
      if (x > value * (1 + kEqual)) *this = {.value = x};
      if (!(x > value * (1 - kEqual))) return;
      ++count;
      rows += row != last_row ? 1 : 0;
      last_row = row;
    }
  };
  PlateauSymptom symptom;
  std::array<Largest, kChannels> rho, signals;
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    if (!valid[bin]) continue;
    ++symptom.valid;
    const double cos_i = cosines(bin).i;
    const int row = bin / table.grid.phi_d;
    for (int c = 0; c < kChannels; ++c) {
      const double value = table.Value(c, bin);
      if (value < rho[c].value / 2 && value * cos_i < signals[c].value / 2) continue;
      rho[c].Add(value, row);
      signals[c].Add(value * cos_i, row);
    }
  }
  for (int c = 0; c < kChannels; ++c) {
    for (const Largest& largest : {rho[c], signals[c]}) {
      if (!(largest.value > 0) || largest.count <= symptom.values) continue;
      symptom.values = largest.count;
      symptom.rows = largest.rows;
    }
  }
  return symptom;
}

QuantizationSymptom QuantizationOf(const BrdfTable& table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  const GridCosines cosines(grid);
  std::vector<double> signals;
  // Leaves out exchanged directions, whose values may be equal.
  for (int row = 0; row < grid.theta_h * grid.theta_d; row += 3) {
    for (int bin = row * grid.phi_d; bin < row * grid.phi_d + (grid.phi_d + 1) / 2; ++bin) {
      const double signal = valid[bin] ? table.Value(1, bin) * cosines(bin).i : 0;
      if (signal > 0) signals.push_back(signal);
    }
  }
  constexpr size_t kFewest = 1000;
  if (signals.size() < kFewest) return {};
  const auto middle = signals.begin() + static_cast<std::ptrdiff_t>(signals.size() / 2);
  std::ranges::nth_element(signals, middle);
  std::sort(signals.begin(), middle);
  int equal = 0;
  for (auto at = signals.begin(); at + 1 != middle; ++at) {
    equal += *(at + 1) <= *at * (1 + kEqual) ? 1 : 0;
  }
  return {.share = 2.0 * equal / static_cast<double>(signals.size())};
}

NoiseSymptom NoiseOf(const BrdfTable& table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  std::vector<double> differences;
  for (int row = 0; row < grid.theta_h * grid.theta_d; row += 3) {
    std::array<double, 4> logs{};  // of the last bins; of a row without gaps all of them
    int there = 0;
    for (int bin = row * grid.phi_d; bin < (row + 1) * grid.phi_d; ++bin) {
      const double value = valid[bin] ? table.Value(1, bin) : 0;
      if (!(value > 0)) {
        there = 0;
        continue;
      }
      std::rotate(logs.begin(), logs.begin() + 1, logs.end());
      logs[3] = std::log(value);
      if (++there < 4) continue;
      differences.push_back(std::abs(logs[0] - 3 * logs[1] + 3 * logs[2] - logs[3]));
    }
  }
  constexpr size_t kFewest = 1000;
  if (differences.size() < kFewest) return {};
  // The median of absolute normal numbers is 0.6745 times their standard deviation; a difference
  // has the variance of 1 + 9 + 9 + 1 values.
  return {.relative = Quantile(&differences, 0.5) / (0.6745 * std::sqrt(20.0))};
}

namespace {

// The shadow of the part in the highlight, which is all that FindOwnShadow examines.
OwnShadow ShadowOf(const BrdfTable& table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  BrdfSamples samples{.source = table.source, .grid = grid, .bins = {}, .angles = {}, .rho = {}};
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (!valid[bin]) continue;
    const HalfDiffAngles at = grid.Center(bin);
    if (at.theta_h > DegreesToRadians(2.5) || at.theta_d > DegreesToRadians(30)) continue;
    samples.bins.push_back(bin);
    samples.rho.push_back({table.Value(0, bin), table.Value(1, bin), table.Value(2, bin)});
  }
  return FindOwnShadow(samples);
}

// The parts, numbers with two digits.
template <typename... Parts>
std::string Said(const Parts&... parts) {
  std::ostringstream text;
  text.precision(2);
  (text << ... << parts);
  return text.str();
}

// The sentences for each symptom present, in this order.
constexpr std::string (*kTelling[])(const BrdfTable&) = {
    [](const BrdfTable& table) -> std::string {
      const CosineSymptom cosine = CosineOf(table);
      if (!cosine.IsOneTooMany() && !cosine.IsOneTooFew()) return "";
      return Said("exchanged directions differ by ", Percent(cosine.error),
                  " in the median, and by ", Percent(cosine.error_without), " ",
                  WhichCosine(cosine.IsOneTooMany()));
    },
    [](const BrdfTable& table) -> std::string {
      const StrayLightSymptom stray = StrayLightOf(table);
      if (!stray.IsThere()) return "";
      return Said("exchanged directions differ by ", Percent(stray.error),
                  " in the median, and by ", Percent(stray.error_without), " without ",
                  Percent(stray.share),
                  " of the median signal: there seems to be as much light from elsewhere in all "
                  "that was measured");
    },
    [](const BrdfTable& table) -> std::string {
      const PlateauSymptom plateau = PlateauOf(table);
      if (!plateau.IsThere()) return "";
      return Said("the largest value is there ", plateau.values,
                  " times, as where a detector is saturated: highlights are brighter than that");
    },
    [](const BrdfTable& table) -> std::string {
      const QuantizationSymptom quantized = QuantizationOf(table);
      if (!quantized.IsThere()) return "";
      return Said(Percent(quantized.share),
                  " of the dark signals are there more than once, as where a measurement has few "
                  "levels");
    },
    [](const BrdfTable& table) -> std::string {
      const NoiseSymptom noise = NoiseOf(table);
      if (!noise.IsThere()) return "";
      return Said("values scatter by ", Percent(noise.relative),
                  " about their neighbours, as noise does, which a fit of many samples averages "
                  "out");
    },
    [](const BrdfTable& table) -> std::string {
      const RepetitionSymptom repeated = RepetitionOf(table);
      if (!repeated.IsThere()) return "";
      return Said("values hardly change any more beyond ", repeated.degrees,
                  " deg, as where what was not measured repeats the last that was; --max_angle=",
                  repeated.degrees, " leaves that out");
    },
    [](const BrdfTable& table) -> std::string {
      const TiltSymptom tilt = TiltOf(table);
      if (!tilt.IsThere()) return "";
      return Said("the highlight is ", std::abs(tilt.degrees),
                  " deg off the mirror direction, as where a sample is tilted by that, or the zero "
                  "of an angle twice as far off; --tilt=",
                  tilt.degrees, " corrects the former");
    },
    [](const BrdfTable& table) -> std::string {
      const OwnShadow shadow = ShadowOf(table);
      if (!(shadow.theta_d_deg > 0)) return "";
      return Said("the highlight is ", std::round(shadow.darker),
                  " times darker towards theta_d = 0 than at 20 to 30 deg, as where a detector "
                  "stands in its own light; --min_theta_d=",
                  shadow.theta_d_deg, " leaves that out");
    }};

}  // namespace

std::string WhichCosine(bool too_many) {
  return too_many ? "with a cosine of theta_i less: values seem to have been multiplied by it, "
                    "which --cosine=1 corrects, or divided by that of theta_o, --cosine=o:-1; "
                    "exchanging directions cannot tell which"
                  : "with a cosine of theta_i more: values seem to have been multiplied by that of "
                    "theta_o, as many instruments give them, which --cosine=o:1 corrects, or "
                    "divided by that of theta_i, --cosine=-1; exchanging directions cannot tell "
                    "which";
}

std::vector<std::string> SymptomsOf(const BrdfTable& table, int num_threads) {
  std::array<std::string, std::size(kTelling)> told;
  ParallelFor(static_cast<int>(told.size()), num_threads,
              [&](int k) { told[k] = kTelling[k](table); });
  std::vector<std::string> symptoms;
  std::ranges::copy_if(told, std::back_inserter(symptoms),
                       [](const std::string& symptom) { return !symptom.empty(); });
  return symptoms;
}

}  // namespace trilobe
