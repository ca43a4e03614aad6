#ifndef TRILOBE_MODEL_MEASUREMENT_BRDF_TABLE_H_
#define TRILOBE_MODEL_MEASUREMENT_BRDF_TABLE_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"

namespace trilobe {

// BRDF [1/sr] = stored value x this, for the R, G and B planes of a MERL file.
inline constexpr Rgb kMerlScale = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

// Why a bin is not a measured one, whatever its value. The first reason found is kept.
enum class Unmeasured : uint8_t {
  kNo,              // measured
  kExtrapolated,    // filled in by the file's authors
  kBeyondNodes,     // theta_i or theta_o is beyond the last theta_i at which the file has data
  kBeyondMaxAngle,  // theta_i or theta_o is beyond the user's limit
  kBelowMinThetaD,  // theta_d is below the user's limit
};

// A measurement in MERL layout. Numbers are kept as a MERL file stores them, so that reading and
// writing a file changes no bit.
struct BrdfTable {
  std::string source;  // file name or synth:NAME, for messages and reports
  MerlGrid grid;
  std::array<std::vector<double>, kChannels> stored;  // [kChannels][grid.size()], < 0 is invalid
  std::vector<Unmeasured> unmeasured = {};            // [grid.size()], or empty: all measured
  double max_theta = kPi / 2;  // [rad] theta_i and theta_o beyond this are not measured

  // BRDF [1/sr] of a bin, valid or not.
  double Value(int channel, int bin) const { return stored[channel][bin] * kMerlScale[channel]; }

  // Stores a BRDF value [1/sr].
  void SetValue(int channel, int bin, double brdf) {
    stored[channel][bin] = brdf / kMerlScale[channel];
  }
};

// Throws Error unless the table has a value of each channel for each bin, and marks for all bins or
// none.
void CheckTable(const BrdfTable& table);

// A table with all bins invalid (-1). This and all functions below throw Error for an invalid grid
// or table.
BrdfTable MakeInvalidTable(const std::string& source, const MerlGrid& grid);

// Whether both directions at a bin's centre are above the surface. [grid.size()]
std::vector<bool> BinsAboveSurface(const MerlGrid& grid);

// Whether a bin is above the surface, measured, and has finite values >= 0 in all channels
// (docs/your-data.md). [grid.size()]
std::vector<bool> ValidBins(const BrdfTable& table);

// The reason that a bin is not measured, or kNo.
inline Unmeasured ReasonOf(const BrdfTable& table, int bin) {
  return table.unmeasured.empty() ? Unmeasured::kNo : table.unmeasured[bin];
}

// max_theta in degrees, for display: exactly 60 if the user entered 60, despite rounding in
// radians.
double MaxAngleDegrees(double max_theta);
double MaxAngleDegrees(const BrdfTable& table);

// Marks bins above the surface with theta_i or theta_o beyond `max_theta` >= 0 [rad] at the centre
// as not measured, for this reason. Bins that are not measured already keep their reason.
void LimitAngles(double max_theta, Unmeasured reason, BrdfTable* table);

// The same for theta_d below `min_theta_d` [rad]; no effect if that is negative.
void LimitThetaD(double min_theta_d, BrdfTable* table);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_BRDF_TABLE_H_
