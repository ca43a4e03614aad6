#include "trilobe/model/brdf_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "trilobe/base/error.h"

namespace trilobe {
namespace {

[[noreturn]] void Fail(const BrdfSamples& samples, const std::string& problem) {
  throw Error(samples.source + ": " + problem);
}

[[noreturn]] void FailAt(const BrdfSamples& samples, int j, const std::string& problem) {
  Fail(samples, "sample " + std::to_string(j) + " " + problem);
}

void CheckSizes(const BrdfSamples& samples) {
  const auto check = [&](const char* what, size_t size) {
    if (size == samples.rho.size()) return;
    Fail(samples, std::to_string(samples.rho.size()) + " samples have " + std::to_string(size) +
                      " " + what + "; each needs one");
  };
  if (samples.on_grid()) {
    check("bins", samples.bins.size());
  } else {
    check("angles", samples.angles.size());
  }
  if (!samples.multiplicity.empty()) check("multiplicities", samples.multiplicity.size());
}

// Tells whether both directions are above the surface at the centre of a bin without a cosine for
// each: cos theta_{i,o} = a -+ b cos phi_d (ToCosines).
class Horizon {
 public:
  explicit Horizon(const MerlGrid& grid) : grid_(grid), cos_phi_(grid.phi_d) {
    for (int p = 0; p < grid.phi_d; ++p) cos_phi_[p] = std::cos(grid.Center(0, 0, p).phi_d);
  }

  bool IsAbove(int bin) {
    const int row = bin / grid_.phi_d;
    if (row != row_) {
      const HalfDiffAngles at = grid_.Center(bin);
      a_ = std::cos(at.theta_h) * std::cos(at.theta_d);
      b_ = std::sin(at.theta_h) * std::sin(at.theta_d);
      row_ = row;
    }
    return a_ - std::abs(b_ * cos_phi_[bin % grid_.phi_d]) > 0;
  }

 private:
  const MerlGrid grid_;
  std::vector<double> cos_phi_;
  int row_ = -1;
  double a_ = 0, b_ = 0;
};

void CheckBins(const BrdfSamples& samples) {
  CheckGrid(samples.grid);
  const int size = samples.grid.size();
  Horizon horizon(samples.grid);
  int last = -1;
  for (int j = 0; j < samples.size(); ++j) {
    const int bin = samples.bins[j];
    if (bin < 0 || bin >= size) {
      FailAt(samples, j,
             "is in bin " + std::to_string(bin) + " of " + std::to_string(size) + " bins");
    }
    if (bin <= last) {
      FailAt(samples, j,
             "is in bin " + std::to_string(bin) + " after one in bin " + std::to_string(last) +
                 "; bins must ascend");
    }
    if (!horizon.IsAbove(bin)) {
      FailAt(samples, j,
             "is in bin " + std::to_string(bin) +
                 ", at whose centre a direction is below the surface");
    }
    last = bin;
  }
}

void CheckAngles(const BrdfSamples& samples) {
  for (int j = 0; j < samples.size(); ++j) {
    try {
      CheckAngles(samples.angles[j]);
    } catch (const Error& error) {
      FailAt(samples, j, std::string("is at angles that are none: ") + error.what());
    }
    const Cosines cosines = ToCosines(samples.angles[j]);
    if (!(cosines.i > 0 && cosines.o > 0)) {
      FailAt(samples, j, "has a direction below the surface");
    }
  }
}

bool IsValid(double x) { return x >= 0 && x <= std::numeric_limits<double>::max(); }

std::string ToText(double x) {
  std::ostringstream text;
  text << x;
  return text.str();
}

}  // namespace

void CheckSamples(const BrdfSamples& samples) {
  CheckSizes(samples);
  if (samples.on_grid()) {
    CheckBins(samples);
  } else {
    CheckAngles(samples);
  }
  for (int j = 0; j < samples.size(); ++j) {
    for (const double rho : samples.rho[j]) {
      if (!IsValid(rho)) FailAt(samples, j, "is " + ToText(rho) + "/sr; it must be 0 or more");
    }
    if (!IsValid(samples.Multiplicity(j))) {
      FailAt(samples, j,
             "counts " + ToText(samples.multiplicity[j]) + " times; it must be 0 or more");
    }
  }
}

double BrdfSamples::SolidAngle(int j) const {
  if (!on_grid()) return 1;
  const int row = bins[j] / grid.phi_d;
  return grid.SolidAngle(row / grid.theta_d, row % grid.theta_d);
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
    throw Error(table.source +
                ": no valid bin: nowhere are both directions above the surface and all three "
                "values finite and >= 0" +
                (table.unmeasured.empty()
                     ? "; check that the file is a BRDF in MERL layout"
                     : " where it was measured; --max_angle and --extrapolated say what counts"));
  }
  return samples;
}

BrdfSamples Selected(const BrdfSamples& samples, const std::vector<int>& numbers) {
  BrdfSamples selected{samples.source, samples.grid, {}, {}, {}};
  CheckSizes(samples);
  for (const int j : numbers) {
    if (j < 0 || j >= samples.size()) {
      Fail(samples,
           "there is no sample " + std::to_string(j) + " among " + std::to_string(samples.size()));
    }
    if (samples.on_grid()) {
      selected.bins.push_back(samples.bins[j]);
    } else {
      selected.angles.push_back(samples.angles[j]);
    }
    selected.rho.push_back(samples.rho[j]);
    if (!samples.multiplicity.empty()) selected.multiplicity.push_back(samples.multiplicity[j]);
  }
  return selected;
}

BrdfSamples Thinned(const BrdfSamples& samples, int stride) {
  if (stride < 1) {
    throw Error("samples cannot be thinned by " + std::to_string(stride) +
                "; give a stride of 1 or more");
  }
  CheckSizes(samples);
  CheckGrid(samples.grid);
  const MerlGrid& grid = samples.grid;
  std::vector<int> kept;
  for (int j = 0; j < samples.size(); ++j) {
    int phase = j;
    if (samples.on_grid()) {
      const int bin = samples.bins[j], row = bin / grid.phi_d, p = bin % grid.phi_d;
      // Primes, which have no common factor with a smaller stride, so that neighbouring rows
      // differ.
      phase =
          std::min(p, grid.phi_d - 1 - p) + 29 * (row / grid.theta_d) + 37 * (row % grid.theta_d);
    }
    if (phase % stride == 0) kept.push_back(j);
  }
  if (kept.empty() && samples.size() > 0) kept.push_back(0);
  return Selected(samples, kept);
}

}  // namespace trilobe
