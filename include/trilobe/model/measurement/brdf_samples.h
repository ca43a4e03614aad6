#ifndef TRILOBE_MODEL_MEASUREMENT_BRDF_SAMPLES_H_
#define TRILOBE_MODEL_MEASUREMENT_BRDF_SAMPLES_H_

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// Measured spectra. wavelengths: [nm], ascending; values: [1/sr], finite and >= 0, [rows][bands].
struct Spectra {
  std::vector<double> wavelengths, values;

  size_t bands() const { return wavelengths.size(); }
  std::span<const double> row(size_t k) const { return {&values[k * bands()], bands()}; }
};

// The samples of a fit: measured directions and values, all valid, from any file format. Samples
// are either at bin centres of `grid` (`bins`, ascending), or scattered (`angles`); then the grid
// only gives the bins of the tables.
struct BrdfSamples {
  std::string source;
  MerlGrid grid;
  std::vector<int> bins;               // [n], or empty when scattered
  std::vector<HalfDiffAngles> angles;  // [n], or empty when on the grid
  std::vector<Rgb> rho;                // [n], BRDF [1/sr], finite and >= 0
  // [n], or empty if all are 1: how often a sample counts, a factor of its weight; finite and >= 0.
  std::vector<double> multiplicity = {};
  // Multiplicities say how often directions occur, as a renderer counts them, in the place of the
  // measure that they have: SolidAngle is 1.
  bool counted = false;
  // [n], or empty: directions of scattered samples, with the order of wi and wo and the azimuths,
  // which `angles` lack and anisotropic models need.
  std::vector<SphericalAngles> directions = {};
  // For a measurement at several wavelengths, whose colour is rho: the spectra, and the row of each
  // sample in them [n]. Copies share the spectra. Otherwise null and empty.
  std::shared_ptr<const Spectra> spectra = nullptr;
  std::vector<int> spectrum_rows = {};

  int size() const { return static_cast<int>(rho.size()); }
  bool on_grid() const { return angles.empty(); }
  // All functions below throw Error if there is no such sample.
  double Multiplicity(int j) const {
    CheckIndex(j, size(), "the sample");
    return multiplicity.empty() ? 1 : multiplicity[j];
  }
  HalfDiffAngles Angles(int j) const {
    if (!on_grid()) {
      CheckIndex(j, static_cast<int64_t>(angles.size()), "the sample");
      return angles[j];
    }
    CheckIndex(j, static_cast<int64_t>(bins.size()), "the sample");
    return grid.Center(bins[j]);
  }
  // cos theta_i and cos theta_o, in the order of `directions` if known; `angles` may exchange them.
  Cosines CosinesOf(int j) const;
  // One row of `new_spectra` for each sample, in order. Throws Error for another number.
  void SetSpectra(Spectra new_spectra);
  // [spectra->bands()]. Throws Error if there are none.
  std::span<const double> SpectrumOf(int j) const;
  // The measure of the sample's direction pairs, up to a constant factor; 1 if scattered or
  // counted.
  double SolidAngle(int j) const;
};

// Throws Error, with the source and the first bad sample, unless the samples are as described
// above: one bin of the grid or angles of directions above the surface for each value.
void CheckSamples(const BrdfSamples& samples);

// The valid bins of a table. Throws Error if there are none.
BrdfSamples ValidSamples(const BrdfTable& table);

// The samples with these indices, in this order. Throws Error for an index out of range.
BrdfSamples Selected(const BrdfSamples& samples, const std::vector<int>& numbers);

// About one in `stride` >= 1 samples, for a cheaper version of the problem. On a grid, each
// (theta_h, theta_d) row keeps every stride-th phi_d and its mirror, 180 degrees - phi_d, from a
// different start; scattered samples are spread evenly over their order. At least one unless there
// are none. Throws Error for other strides.
BrdfSamples Thinned(const BrdfSamples& samples, int stride);

// Every other (theta_h, theta_d) row, as on a chessboard; at least one sample unless there are
// none. Throws Error for scattered samples.
BrdfSamples InEveryOtherRow(const BrdfSamples& samples);

// Samples of a grid with half the bins of theta_h and theta_d: means of up to four samples, with
// the sum of their multiplicities, at one in `stride` >= 1 bins chosen as in Thinned. Bins whose
// centre is below the surface are omitted. Throws Error for other strides, scattered samples, and
// odd numbers of theta_h or theta_d bins.
BrdfSamples MeansOfFourBins(const BrdfSamples& samples, int stride);

// About `count` >= 1 samples for a mean, spread evenly over their order (on a grid, over all
// phi_d), or all if there are fewer than twice as many. Throws Error for other counts.
BrdfSamples EvenlySpread(const BrdfSamples& samples, int count);

// Like Thinned with smaller strides, down to 1, where samples are sparse: about `least` >= 1 remain
// in each bin of theta_h, of theta_d, and each degree of theta_i and theta_o, if there are as many.
// Multiplicities are scaled by the local stride. Throws Error as above.
BrdfSamples ThinnedByPlace(const BrdfSamples& samples, int stride, int least);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_BRDF_SAMPLES_H_
