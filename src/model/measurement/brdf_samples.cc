#include "trilobe/model/measurement/brdf_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "core/base/grid_cosines.h"
#include "core/base/text.h"
#include "model/measurement/sample_numbers.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// An error about sample j.
[[noreturn]] void FailAt(const BrdfSamples& samples, int j, const std::string& problem,
                         std::string_view value) {
  const std::string key = "sample " + std::to_string(j);
  throw ErrorIn(ErrorKind::kRange, samples.source, key + " " + problem).About(key, value);
}

void CheckSizes(const BrdfSamples& samples) {
  const auto check = [&](const char* what, size_t size) {
    if (size == samples.rho.size()) return;
    throw ErrorIn(ErrorKind::kMismatch, samples.source,
                  std::to_string(samples.rho.size()) + " samples have " + std::to_string(size) +
                      " " + what + "; each needs one")
        .About(what, size);
  };
  if (samples.on_grid()) {
    check("bins", samples.bins.size());
  } else {
    check("angles", samples.angles.size());
  }
  if (!samples.multiplicity.empty()) check("multiplicities", samples.multiplicity.size());
  if (!samples.directions.empty()) check("pairs of directions", samples.directions.size());
  if (samples.spectra != nullptr) check("spectra", samples.spectrum_rows.size());
}

// One pass over bins that ascend.
void CheckBins(const BrdfSamples& samples) {
  const MerlGrid& grid = samples.grid;
  const GridCosines cosines(grid);
  int last = -1;
  for (int j = 0; j < samples.size(); ++j) {
    const int bin = samples.bins[j];
    if (bin <= last || bin >= grid.size()) {
      FailAt(samples, j,
             "is in bin " + std::to_string(bin) + " of " + std::to_string(grid.size()) +
                 (last < 0 ? "" : ", after one in bin " + std::to_string(last)) +
                 "; bins must exist and ascend",
             "bin " + std::to_string(bin));
    }
    const auto [cos_i, cos_o] = cosines(bin);
    if (!(cos_i > 0 && cos_o > 0)) {
      FailAt(
          samples, j,
          "is in bin " + std::to_string(bin) + ", at whose centre a direction is below the surface",
          "below the surface");
    }
    last = bin;
  }
}

void CheckAngles(const BrdfSamples& samples) {
  for (int j = 0; j < samples.size(); ++j) {
    try {
      CheckAngles(samples.angles[j]);
    } catch (const Error& error) {
      FailAt(samples, j, std::string("is at angles that are none: ") + error.what(), "angles");
    }
    const Cosines cosines = ToCosines(samples.angles[j]);
    if (!(cosines.i > 0 && cosines.o > 0)) {
      FailAt(samples, j, "has a direction below the surface", "below the surface");
    }
    if (!samples.directions.empty() && !IsAboveSurface(samples.directions[j])) {
      FailAt(samples, j, "has a direction that is none, or below the surface", "directions");
    }
  }
}

bool IsValid(double x) { return x >= 0 && x <= std::numeric_limits<double>::max(); }

bool AreValid(std::span<const double> values) {
  // 0 * x is NaN for an infinite or NaN x, and the minimum is negative if a value is.
  const double* const x = values.data();
  const size_t size = values.size();
  double least = 0, zero = 0;
#pragma omp simd reduction(min : least) reduction(+ : zero)
  for (size_t k = 0; k < size; ++k) {
    least = x[k] < least ? x[k] : least;
    zero += 0 * x[k];
  }
  return least == 0 && zero == 0;
}

}  // namespace

void CheckSamples(const BrdfSamples& samples) {
  CheckSizes(samples);
  if (samples.on_grid()) {
    CheckBins(samples);
  } else {
    CheckAngles(samples);
  }
  // Checks all at once first, which is several times as fast.
  const bool valid = AreValid({samples.rho.empty() ? nullptr : samples.rho.front().data(),
                               samples.rho.size() * kChannels}) &&
                     AreValid(samples.multiplicity);
  for (int j = 0; j < samples.size() && !valid; ++j) {
    for (const double rho : samples.rho[j]) {
      if (!IsValid(rho)) {
        FailAt(samples, j, "is " + Text(rho, 6) + "/sr; it must be 0 or more", FactText(rho));
      }
    }
    if (!IsValid(samples.Multiplicity(j))) {
      FailAt(samples, j,
             "counts " + Text(samples.multiplicity[j], 6) + " times; it must be 0 or more",
             "multiplicity");
    }
  }
}

void BrdfSamples::SetSpectra(Spectra new_spectra) {
  if (new_spectra.values.size() != rho.size() * new_spectra.bands()) {
    throw ErrorIn(ErrorKind::kMismatch, source,
                  std::to_string(rho.size()) + " samples need a spectrum each")
        .About("spectra", new_spectra.values.size());
  }
  spectra = std::make_shared<const Spectra>(std::move(new_spectra));
  spectrum_rows.resize(rho.size());
  std::iota(spectrum_rows.begin(), spectrum_rows.end(), 0);
}

std::span<const double> BrdfSamples::SpectrumOf(int j) const {
  CheckIndex(j, static_cast<int64_t>(spectrum_rows.size()), "the spectrum");
  return spectra->row(spectrum_rows[j]);
}

double BrdfSamples::SolidAngle(int j) const {
  CheckIndex(j, size(), "the sample");
  if (!on_grid() || counted) return 1;
  const int row = bins[j] / grid.phi_d;
  return grid.SolidAngle(row / grid.theta_d, row % grid.theta_d);
}

Cosines BrdfSamples::CosinesOf(int j) const {
  if (directions.empty()) return ToCosines(Angles(j));
  CheckIndex(j, static_cast<int64_t>(directions.size()), "the sample");
  return {std::cos(directions[j].theta_i), std::cos(directions[j].theta_o)};
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
    throw ErrorIn(
        ErrorKind::kData, table.source,
        std::string("no valid bin: nowhere are both directions above the surface and all three "
                    "values finite and >= 0") +
            (table.unmeasured.empty()
                 ? "; check that the file is a BRDF in MERL layout"
                 : " where it was measured; --max_angle, --min_theta_d and --extrapolated say what "
                   "counts"))
        .About("bins");
  }
  return samples;
}

BrdfSamples Selected(const BrdfSamples& samples, const std::vector<int>& numbers) {
  BrdfSamples selected{samples.source, samples.grid, {}, {}, {}};
  selected.counted = samples.counted;
  CheckSizes(samples);
  const auto reserve = [&](const auto& all, auto* chosen) {
    if (!all.empty()) chosen->reserve(numbers.size());
  };
  reserve(samples.bins, &selected.bins);
  reserve(samples.angles, &selected.angles);
  reserve(samples.rho, &selected.rho);
  reserve(samples.directions, &selected.directions);
  reserve(samples.multiplicity, &selected.multiplicity);
  for (const int j : numbers) {
    if (j < 0 || j >= samples.size()) {
      throw ErrorIn(
          ErrorKind::kRange, samples.source,
          "there is no sample " + std::to_string(j) + " among " + std::to_string(samples.size()))
          .About("sample", j);
    }
    if (samples.on_grid()) {
      selected.bins.push_back(samples.bins[j]);
    } else {
      selected.angles.push_back(samples.angles[j]);
    }
    selected.rho.push_back(samples.rho[j]);
    if (!samples.directions.empty()) selected.directions.push_back(samples.directions[j]);
    if (!samples.multiplicity.empty()) selected.multiplicity.push_back(samples.multiplicity[j]);
    if (samples.spectra != nullptr) selected.spectrum_rows.push_back(samples.spectrum_rows[j]);
  }
  selected.spectra = samples.spectra;
  return selected;
}

namespace {

void CheckStride(int stride) {
  if (stride >= 1) return;
  throw Error(ErrorKind::kRange, "samples cannot be thinned by " + std::to_string(stride) +
                                     "; give a stride of 1 or more")
      .About("stride", stride);
}

// A phase of each grid sample, equal for exchanged pairs, such that samples with phases divisible
// by a stride are spread evenly. Primes have no factor in common with smaller strides, so
// neighbouring rows differ.
int PhaseOnGrid(const MerlGrid& grid, int h, int d, int p) {
  return std::min(p, grid.phi_d - 1 - p) + 29 * h + 37 * d;
}

int PhaseOnGrid(const BrdfSamples& samples, int j) {
  const MerlGrid& grid = samples.grid;
  const int bin = samples.bins[j], row = bin / grid.phi_d;
  return PhaseOnGrid(grid, row / grid.theta_d, row % grid.theta_d, bin % grid.phi_d);
}

// Fractional parts of multiples of the golden ratio: evenly spread over any regular order.
double GoldenFraction(int n) {
  constexpr double kGolden = 0.6180339887498949;
  const double place = n * kGolden;
  return place - std::floor(place);
}

}  // namespace

std::vector<int> ThinnedNumbers(int size, int stride) {
  CheckStride(stride);
  std::vector<int> kept;
  for (int j = 0; j < size; ++j) {
    if (static_cast<int>(GoldenFraction(j) * stride) % stride == 0) kept.push_back(j);
  }
  if (kept.empty() && size > 0) kept.push_back(0);
  return kept;
}

BrdfSamples Thinned(const BrdfSamples& samples, int stride) {
  CheckStride(stride);
  CheckSizes(samples);
  CheckGrid(samples.grid);
  if (!samples.on_grid()) return Selected(samples, ThinnedNumbers(samples.size(), stride));
  std::vector<int> kept;
  for (int j = 0; j < samples.size(); ++j) {
    if (PhaseOnGrid(samples, j) % stride == 0) kept.push_back(j);
  }
  if (kept.empty() && samples.size() > 0) kept.push_back(0);
  return Selected(samples, kept);
}

BrdfSamples InEveryOtherRow(const BrdfSamples& samples) {
  CheckSizes(samples);
  CheckGrid(samples.grid);
  if (!samples.on_grid()) {
    throw ErrorIn(ErrorKind::kUnsupported, samples.source, "scattered samples have no rows")
        .About("rows");
  }
  const MerlGrid& grid = samples.grid;
  std::vector<int> kept;
  for (int j = 0; j < samples.size(); ++j) {
    const int row = samples.bins[j] / grid.phi_d;
    if ((row / grid.theta_d + row % grid.theta_d) % 2 == 0) kept.push_back(j);
  }
  if (kept.empty() && samples.size() > 0) kept.push_back(0);
  return Selected(samples, kept);
}

BrdfSamples MeansOfFourBins(const BrdfSamples& samples, int stride) {
  CheckStride(stride);
  CheckSizes(samples);
  CheckGrid(samples.grid);
  const MerlGrid& fine = samples.grid;
  if (!samples.on_grid() || fine.theta_h % 2 != 0 || fine.theta_d % 2 != 0) {
    throw ErrorIn(ErrorKind::kUnsupported, samples.source,
                  "means of four bins are of samples on a grid with an even "
                  "number of theta_h and of theta_d")
        .About("bins");
  }
  const MerlGrid grid{
      .theta_h = fine.theta_h / 2, .theta_d = fine.theta_d / 2, .phi_d = fine.phi_d};
  std::vector<Rgb> sums(grid.size(), Rgb{});
  std::vector<double> counts(grid.size(), 0.0);
  for (int j = 0; j < samples.size(); ++j) {
    const int bin = samples.bins[j], row = bin / fine.phi_d, p = bin % fine.phi_d;
    const int h = row / fine.theta_d / 2, d = row % fine.theta_d / 2;
    if (PhaseOnGrid(grid, h, d, p) % stride != 0) continue;
    const int mean = grid.Index(h, d, p);
    const double count = samples.Multiplicity(j);
    for (int c = 0; c < kChannels; ++c) sums[mean][c] += count * samples.rho[j][c];
    counts[mean] += count;
  }
  BrdfSamples means{samples.source, grid, {}, {}, {}};
  means.counted = samples.counted;
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (!above[bin] || !(counts[bin] > 0)) continue;
    Rgb mean;
    for (int c = 0; c < kChannels; ++c) mean[c] = sums[bin][c] / counts[bin];
    means.bins.push_back(bin);
    means.rho.push_back(mean);
    means.multiplicity.push_back(counts[bin]);
  }
  return means;
}

std::vector<int> EvenlySpreadNumbers(int size, const MerlGrid& grid, int count) {
  CheckNumber("the number of samples", count, count >= 1, "1 or more");
  int stride = std::max(1, size / count);
  // A stride coprime to the number of phi_d bins visits all of these.
  while (std::gcd(stride, grid.phi_d) > 1) ++stride;
  std::vector<int> kept;
  for (int j = 0; j < size; j += stride) kept.push_back(j);
  return kept;
}

BrdfSamples EvenlySpread(const BrdfSamples& samples, int count) {
  return Selected(samples, EvenlySpreadNumbers(samples.size(), samples.grid, count));
}

BrdfSamples ThinnedByPlace(const BrdfSamples& samples, int stride, int least) {
  CheckStride(stride);
  if (least < 1) {
    throw Error(ErrorKind::kRange,
                "at least " + std::to_string(least) + " samples a place; give 1 or more")
        .About("least", least);
  }
  CheckSamples(samples);
  // Bins of theta_h, theta_d, theta_i and theta_o; the last two may be exchanged and share a table.
  const MerlGrid& grid = samples.grid;
  using Places = std::array<int, 4>;
  const auto places_of = [&](int j) -> Places {
    const HalfDiffAngles angles = samples.Angles(j);
    const Cosines cosines = ToCosines(angles);
    const auto degree = [](double cosine) {
      return std::min(static_cast<int>(RadiansToDegrees(std::acos(std::min(cosine, 1.0)))), 89);
    };
    const auto bin = [](double coordinate, int bins) {
      return std::clamp(static_cast<int>(coordinate), 0, bins - 1);
    };
    const int d = grid.theta_h, i = d + grid.theta_d;
    return {bin(grid.ThetaHCoordinate(angles.theta_h), grid.theta_h),
            d + bin(grid.ThetaDCoordinate(angles.theta_d), grid.theta_d), i + degree(cosines.i),
            i + degree(cosines.o)};
  };
  std::vector<int> counts(grid.theta_h + grid.theta_d + 90, 0);
  std::vector<Places> places(samples.size());
  for (int j = 0; j < samples.size(); ++j) {
    places[j] = places_of(j);
    for (const int place : places[j]) ++counts[place];
  }
  std::vector<int> kept;
  std::vector<double> strides;
  for (int j = 0; j < samples.size(); ++j) {
    int fewest = samples.size();
    for (const int place : places[j]) fewest = std::min(fewest, counts[place]);
    const int own_stride = std::clamp(fewest / least, 1, stride);
    // Independent of the remainders used by Thinned, which may thin the result again.
    const int number = samples.on_grid() ? PhaseOnGrid(samples, j) : j;
    if (GoldenFraction(number) * own_stride >= 1) continue;
    kept.push_back(j);
    strides.push_back(own_stride);
  }
  if (kept.empty() && samples.size() > 0) {
    kept.push_back(0);
    strides.push_back(samples.size());
  }
  BrdfSamples thinned = Selected(samples, kept);
  thinned.multiplicity.resize(kept.size(), 1);
  for (size_t k = 0; k < kept.size(); ++k) thinned.multiplicity[k] *= strides[k];
  return thinned;
}

}  // namespace trilobe
