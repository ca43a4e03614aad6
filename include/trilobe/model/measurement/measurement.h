#ifndef TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_H_
#define TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_H_

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe {

// What data that can be read between their samples say of a pair of directions.
struct MeasuredValue {
  Rgb rho{};             // [1/sr], >= 0; 0 where a direction is below the surface
  bool measured = true;  // and not made up by whoever wrote the file
};

// What was measured of a material, and where it comes from: a table where the data are on a MERL
// grid, else scattered samples.
struct Measurement {
  std::string source;  // file name or synth:NAME, for messages and reports
  std::string kind;    // "MERL measurement"
  std::optional<BrdfTable> table = {};
  // Of data that can be read between their samples, as those of an RGL file.
  std::function<MeasuredValue(const DirectionPair&)> look_up = nullptr;
  bool anisotropic = false;             // azimuths matter, not only how far apart they are
  BrdfFunction formula = nullptr;       // of a synthetic material: what was measured
  std::vector<std::string> notes = {};  // one sentence each: what looks wrong in the data

  // Of scattered data:
  BrdfSamples samples = {};    // the valid ones, with their directions
  BinCounts counts = {};       // samples of the file: all, valid ones, why others were left out
  int out_of_gamut = 0;        // with a channel set to 0, as sRGB cannot show the colour
  double max_theta = kPi / 2;  // [rad] no theta_i or theta_o of a valid sample is beyond this
};

// What a fit sees of it. Throws Error where nothing is valid.
BrdfSamples SamplesOf(const Measurement& measurement);

// The table. Throws Error, which says that a table is needed, where there is none.
const BrdfTable& TableOf(const Measurement& measurement);
BrdfTable TableOf(Measurement&& measurement);

// Bins or samples: all, valid ones, and why the others are left out.
BinCounts CountsOf(const Measurement& measurement);

// theta_i and theta_o of what is valid are at most this, in degrees, to show.
double MaxAngleDegrees(const Measurement& measurement);

// Throws Error, with the source, unless each scattered sample knows its directions and its value.
// All that follows does.
void CheckDirections(const Measurement& scattered);

// From now on nothing is valid where theta_i or theta_o is beyond `max_theta` >= 0 [rad].
void LimitAngles(double max_theta, Measurement* measurement);

// The same where theta_d is below `min_theta_d` [rad], nowhere if that is below 0.
void LimitThetaD(double min_theta_d, Measurement* measurement);

// The same of scattered samples where they show that the detector stood in its own light
// (OwnShadow), with a note that says so.
void LeaveOutOwnShadow(Measurement* measurement);

// Leaves out the samples that are far off what surrounds them (FindOutliers), as if they were lost,
// with a note that says so, where they are 10 or more, of scattered samples one in 500 or more, and
// off by 2e-5 of the light that is reflected, or more: clean materials have some that are no error,
// in the dark; those that are off by less than 8 times only where they are one in 500 or more.
// Where azimuths matter, instead, those that are 0 while one with wi and wo exchanged is not.
void LeaveOutOutliers(int num_threads, Measurement* measurement);

// Of a table, replaces readings that are lost in dark noise by medians of what surrounds them
// (SmoothDarkReadings), with a note that says so, where there is such noise.
void SmoothDarkReadings(int num_threads, Measurement* measurement);

// Leaves out a share, from 0 up to 1, of the valid bins or samples, chosen by `seed`, as if it had
// been lost: a table marks them as it marks lost bins, and of samples they are missing. Throws
// Error for other shares.
void LeaveOutAtRandom(double share, uint64_t seed, Measurement* measurement);

// How far apart scattered samples are that were measured in both directions: those with
// (theta_i, theta_o) against those with the two swapped, at the same angle between the azimuths or,
// where azimuths matter, at the same azimuths, to 1e-6. What was measured several times counts by
// its mean.
PairError ReciprocityError(const Measurement& scattered);

// Gathers scattered samples as a reader finds them, and counts what is not valid: a direction below
// the surface, a value that is not finite, one below 0 (docs/samples.md).
class SampleCollector {
 public:
  SampleCollector(const std::string& source, const std::string& kind);
  void Add(const SphericalAngles& angles, const Rgb& rho);  // [1/sr]
  // A channel below 0, which no measured value is, becomes 0; for colours of valid spectra.
  void AddColor(const SphericalAngles& angles, const Rgb& rho);
  // Counts a sample that the file itself marks as none.
  void LeaveOut(int BinCounts::*reason);
  Measurement Take();
  // The same of a format that does not say whether azimuths matter: they do where light comes from
  // several, at theta_i > 0.
  Measurement TakeByAzimuths();

 private:
  Measurement measurement_;
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_MEASUREMENT_H_
