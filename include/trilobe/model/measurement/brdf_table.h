#ifndef TRILOBE_MODEL_MEASUREMENT_BRDF_TABLE_H_
#define TRILOBE_MODEL_MEASUREMENT_BRDF_TABLE_H_

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/core/geometry/merl_grid.h"

namespace trilobe {

// BRDF [1/sr] = stored value x this, for the planes R, G, B of a MERL file.
inline constexpr Rgb kMerlScale = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

// Why a bin does not count as measured, whatever value it holds. Of several reasons the first that
// was found stays.
enum class Unmeasured : uint8_t {
  kNo,              // it was measured
  kExtrapolated,    // filled by the authors of the file, from other directions
  kBeyondNodes,     // theta_i or theta_o is beyond the last theta_i at which the file has data
  kBeyondMaxAngle,  // theta_i or theta_o is beyond the angle that the user set
  kBelowMinThetaD,  // theta_d is below the one that the user set
};

// A measurement in MERL layout. It keeps the numbers as a MERL file stores them, so that reading
// and writing one changes no bit.
struct BrdfTable {
  std::string source;  // file name or synth:NAME, for messages and reports
  MerlGrid grid;
  std::array<std::vector<double>, kChannels> stored;  // [kChannels][grid.size()], < 0 is invalid
  std::vector<Unmeasured> unmeasured = {};  // [grid.size()], or empty where all bins are measured
  double max_theta = kPi / 2;  // [rad] theta_i and theta_o beyond this are not measured

  // BRDF [1/sr] of one bin, whether valid or not.
  double Value(int channel, int bin) const { return stored[channel][bin] * kMerlScale[channel]; }

  // Stores a BRDF value [1/sr].
  void SetValue(int channel, int bin, double brdf) {
    stored[channel][bin] = brdf / kMerlScale[channel];
  }
};

// Throws Error unless the table has a value of each channel for each bin, and a mark of each or
// none.
void CheckTable(const BrdfTable& table);

// A table of `grid` where every bin is marked invalid (-1).
// These and what follows throw Error for a grid or a table that is none.
BrdfTable MakeInvalidTable(const std::string& source, const MerlGrid& grid);

// True where both directions are above the surface at the bin's centre. [grid.size()]
std::vector<bool> BinsAboveSurface(const MerlGrid& grid);

// True where the bin is above the surface, all three stored values are finite and >= 0, and it was
// measured (docs/samples.md). [grid.size()]
std::vector<bool> ValidBins(const BrdfTable& table);

// What the table says of one bin.
inline Unmeasured ReasonOf(const BrdfTable& table, int bin) {
  return table.unmeasured.empty() ? Unmeasured::kNo : table.unmeasured[bin];
}

// An angle, table.max_theta, in degrees, to show: 60 where the user said 60, whatever radians made
// of it.
double MaxAngleDegrees(double max_theta);
double MaxAngleDegrees(const BrdfTable& table);

// From now on nothing is measured where theta_i or theta_o, at the centre of a bin above the
// surface, is beyond `max_theta` >= 0 [rad]. Bins that were not measured before keep their reason.
void LimitAngles(double max_theta, Unmeasured reason, BrdfTable* table);

// The same where theta_d is below `min_theta_d` [rad], nowhere if that is below 0.
void LimitThetaD(double min_theta_d, BrdfTable* table);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_BRDF_TABLE_H_
