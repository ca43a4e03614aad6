#include "brdf/symptoms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <sstream>

#include "brdf/own_shadow.h"
#include "geometry/grid_cosines.h"
#include "math/quantile.h"
#include "trilobe/brdf/brdf_samples.h"
#include "trilobe/geometry/channels.h"

namespace trilobe {
namespace {

constexpr double kEqual = 1e-9;  // relative

double MeanOfBin(const BrdfTable& table, int bin) {
  return Mean({table.Value(0, bin), table.Value(1, bin), table.Value(2, bin)});
}

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

CosineSymptom CosineOf(const BrdfTable& table) {
  const MerlGrid& grid = table.grid;
  const std::vector<bool> valid = ValidBins(table);
  const GridCosines cosines(grid);
  std::vector<double> exponents, x, y;
  constexpr double kApart = 1.5;
  for (int h = 0; h < grid.theta_h; h += 2) {
    for (int d = h % 3; d < grid.theta_d; d += 3) {
      for (int p = 0; p < grid.phi_d / 2; ++p) {
        const int a = grid.Index(h, d, p), b = grid.Index(h, d, grid.phi_d - 1 - p);
        if (!valid[a] || !valid[b]) continue;
        const auto [cos_i, cos_o] = cosines(h, d, p);
        const double apart = std::log(cos_i / cos_o);
        if (!(std::abs(apart) > std::log(kApart))) continue;
        const double first = MeanOfBin(table, a), second = MeanOfBin(table, b);
        if (!(first > 0 && second > 0)) continue;
        x.push_back(apart);
        y.push_back(std::log(first / second));
        exponents.push_back(y.back() / x.back());
      }
    }
  }
  constexpr size_t kFewest = 100;
  if (exponents.size() < kFewest) return {};
  CosineSymptom symptom{.exponent = Quantile(&exponents, 0.5)};
  const double nearer = symptom.exponent > 0 ? 1 : -1;
  std::vector<double> without(y.size());
  for (size_t k = 0; k < y.size(); ++k) {
    without[k] = std::abs(y[k] - nearer * x[k]);
    y[k] = std::abs(y[k]);
  }
  symptom.error = Quantile(&y, 0.5);
  symptom.error_without = Quantile(&without, 0.5);
  return symptom;
}

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
  // Not those with the directions exchanged, which may be equal.
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
        // wi is at phi_d from the direction in which h is off the normal.
        const HalfDiffAngles at = grid.Center(bin);
        along += above * at.theta_h * std::cos(at.phi_d);
      }
    }
    // A highlight, and not the light of all directions.
    if (!(light > 0 && at_rim > 0 && rim / at_rim < largest / 3)) continue;
    middles.push_back(RadiansToDegrees(along / light));
  }
  constexpr size_t kFewest = 10;
  if (middles.size() < kFewest) return {};
  return {.degrees = Quantile(&middles, 0.5),
          .spread = Quantile(&middles, 0.75) - Quantile(&middles, 0.25)};
}

namespace {

// That of the highlight, which is all that FindOwnShadow looks at.
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

}  // namespace

std::vector<std::string> SymptomsOf(const BrdfTable& table) {
  std::vector<std::string> symptoms;
  const auto tell = [&](const auto&... parts) {
    std::ostringstream text;
    text.precision(2);
    (text << ... << parts);
    symptoms.push_back(text.str());
  };
  const CosineSymptom cosine = CosineOf(table);
  if (cosine.IsOneTooMany() || cosine.IsOneTooFew()) {
    const int k = cosine.IsOneTooMany() ? 1 : -1;
    tell("exchanged directions differ by ", Percent(cosine.error), " in the median, and by ",
         Percent(cosine.error_without), " with a cosine of theta_i ", k > 0 ? "less" : "more",
         ": values seem to have been ", k > 0 ? "multiplied" : "divided",
         " by it once; --cosine=", k, " corrects that");
  }
  if (const PlateauSymptom plateau = PlateauOf(table); plateau.IsThere()) {
    tell("the largest value is there ", plateau.values,
         " times, as where a detector is saturated: highlights are brighter than that");
  }
  if (const QuantizationSymptom quantized = QuantizationOf(table); quantized.IsThere()) {
    tell(Percent(quantized.share),
         " of the dark signals are there more than once, as where a measurement has few levels");
  }
  if (const TiltSymptom tilt = TiltOf(table); tilt.IsThere()) {
    tell("the highlight is ", std::abs(tilt.degrees),
         " deg off the mirror direction, as where a sample is tilted by that, or the zero of an "
         "angle twice as far off; --tilt=",
         tilt.degrees, " corrects the former");
  }
  if (const OwnShadow shadow = ShadowOf(table); shadow.theta_d_deg > 0) {
    tell("the highlight is ", std::round(shadow.darker),
         " times darker towards theta_d = 0 than at 20 to 30 deg, as where a detector stands in "
         "its own light; --min_theta_d=",
         shadow.theta_d_deg, " leaves that out");
  }
  return symptoms;
}

}  // namespace trilobe
