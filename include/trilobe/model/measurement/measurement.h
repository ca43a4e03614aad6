#ifndef TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_H_
#define TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe {

// An interpolated value of a measurement.
struct MeasuredValue {
  Rgb rho{};             // [1/sr], >= 0; 0 if a direction is below the surface
  bool measured = true;  // false: extrapolated by the file's authors
};

// A measurement of a material: a table if the data are on a MERL grid, else scattered samples.
//
//   Measurement m = Source("silk.csv").Read();  // trilobe/io/formats/source.h
//   LimitAngles(DegreesToRadians(80), &m);
//   const BrdfSamples samples = SamplesOf(m);
struct Measurement {
  std::string source;  // file name or synth:NAME, for messages and reports
  std::string kind;    // "MERL measurement"
  std::string xxh128 =
      {};  // checksum of the file, as `xxh128sum` prints it; empty if there is none
  std::optional<BrdfTable> table = {};
  // Interpolates data that allow it, such as an RGL file.
  std::function<MeasuredValue(const DirectionPair&)> look_up = nullptr;
  // Azimuths of light and detector are given, not only their difference: values may depend on them.
  bool anisotropic = false;
  bool azimuths_matter = false;         // whoever made an anisotropic one says that they do
  BrdfFunction formula = nullptr;       // the exact BRDF of a synthetic material
  std::vector<std::string> notes = {};  // sentences about suspicious data

  // For scattered data:
  // Valid samples, with directions. Of a table made of spectra, some of its bins, with these.
  BrdfSamples samples = {};
  BinCounts counts = {};       // samples in the file: all, valid, left out by reason
  int bands = 0;               // wavelengths of the spectra that were read; 0: there are none
  int out_of_gamut = 0;        // samples with a channel set to 0, outside sRGB
  double max_theta = kPi / 2;  // [rad] upper bound of theta_i and theta_o of valid samples
};

// The valid samples, for a fit: scattered ones of an isotropic material count less where they are
// dense (EvenOutDensity). Throws Error if there are none.
BrdfSamples SamplesOf(const Measurement& measurement);

// The table. Throws Error if there is none.
const BrdfTable& TableOf(const Measurement& measurement);
BrdfTable TableOf(Measurement&& measurement);

// Numbers of bins or samples: all, valid, and left out by reason.
BinCounts CountsOf(const Measurement& measurement);

// Upper bound of theta_i and theta_o of valid data, in degrees, for display.
double MaxAngleDegrees(const Measurement& measurement);

// Throws Error, with the source, unless each scattered sample has directions and a value. All
// functions below check this.
void CheckDirections(const Measurement& scattered);

// Marks data with theta_i or theta_o beyond `max_theta` >= 0 [rad] as not valid.
void LimitAngles(double max_theta, Measurement* measurement);

// The same for theta_d below `min_theta_d` [rad]; no effect if that is negative.
void LimitThetaD(double min_theta_d, Measurement* measurement);

// The same for scattered samples shaded by the detector (OwnShadow), if any; adds a note.
void LeaveOutOwnShadow(Measurement* measurement);

// Leaves out scattered samples that were filled in, not measured: angles of a grid that repeat
// those before (FindFilled), and zeros amid light (FindZeroGaps); adds a note for each. No effect
// on tables and anisotropic measurements.
void LeaveOutFill(Measurement* measurement);
void LeaveOutZeroGaps(Measurement* measurement);
// Leaves out scattered samples with a value that marks what was not measured, as 9999; adds a note.
void LeaveOutMarks(Measurement* measurement);

// Leaves out outliers (FindOutliers) and adds a note, if there are at least 10 (scattered samples:
// and one in 500) and they change the reflected light by at least 2e-5; clean materials have a few
// in the dark. Outliers by a factor below 8 count only if they are at least 10 and one in 500. For
// anisotropic data, instead, outliers are samples of 0 whose exchanged sample is not 0.
void LeaveOutOutliers(int num_threads, Measurement* measurement);

// For tables, replaces readings lost in dark noise by medians of their neighbours
// (SmoothDarkReadings) and adds a note, if there is such noise.
void SmoothDarkReadings(int num_threads, Measurement* measurement);

// Makes a table of scattered samples that stand at the centres of the bins of a MerlGrid, most of
// those up to their largest angle and none twice, as a table that was written as text does; adds a
// note. No effect where azimuths matter, and on spectra.
void TakeMerlBinsAsTable(Measurement* measurement);

// Turns phi_o of scattered samples by 180 degrees, for those whose azimuths are counted from the
// mirror direction.
void TurnAzimuths(Measurement* scattered);

// Leaves out a random share in [0, 1) of the valid bins or samples, chosen by `seed`, as lost data:
// bins are marked lost, samples removed. Throws Error for other shares.
void LeaveOutAtRandom(double share, uint64_t seed, Measurement* measurement);

// Deviation of scattered samples from reciprocity: those with (theta_i, theta_o) against those with
// the two swapped, at the same azimuth difference or, for anisotropic data, the same azimuths, to
// 1e-6. Repeated measurements are averaged.
PairError ReciprocityError(const Measurement& scattered);

// Collects scattered samples for a reader and counts invalid ones: a direction below the surface, a
// value that is negative or not finite (docs/your-data.md).
class SampleCollector {
 public:
  SampleCollector(const std::string& source, const std::string& kind);
  // Both return whether the sample is valid. rho: [1/sr].
  bool Add(const SphericalAngles& angles, const Rgb& rho);
  // Clamps negative channels to 0, for colours computed from valid spectra.
  bool AddColor(const SphericalAngles& angles, const Rgb& rho);
  // The spectrum [1/sr] of the valid sample that was added last. Each has one, at the same
  // wavelengths [nm], or none has.
  void KeepSpectrum(std::span<const double> wavelengths, std::span<const double> spectrum);
  // Counts a sample that the file marks as invalid.
  void LeaveOut(int BinCounts::*reason);
  Measurement Take();
  // The same for formats that do not tell whether data are anisotropic: they are if light comes
  // from several azimuths at theta_i > 0.
  Measurement TakeByAzimuths();

 private:
  // Directions at the same angles as before are not computed anew: most readers go on by one angle.
  DirectionPair DirectionsOf(const SphericalAngles& angles);

  Measurement measurement_;
  PolarAngles last_i_, last_o_;
  DirectionPair last_{{0, 0, 1}, {0, 0, 1}};
  Spectra spectra_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_H_
