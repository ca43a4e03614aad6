#ifndef TRILOBE_MODEL_BRDF_TABLE_H_
#define TRILOBE_MODEL_BRDF_TABLE_H_

#include <array>
#include <string>
#include <vector>

#include "trilobe/model/channels.h"
#include "trilobe/model/merl_grid.h"

namespace trilobe {

// BRDF [1/sr] = stored value x this, for the planes R, G, B of a MERL file.
inline constexpr Rgb kMerlScale = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

// A measurement in MERL layout. It keeps the numbers as a MERL file stores them, so that reading
// and writing one changes no bit.
struct BrdfTable {
  std::string source;  // file name or synth:NAME, for messages and reports
  MerlGrid grid;
  std::array<std::vector<double>, kChannels> stored;  // [kChannels][grid.size()], < 0 is invalid

  // BRDF [1/sr] of one bin, whether valid or not.
  double Value(int channel, int bin) const { return stored[channel][bin] * kMerlScale[channel]; }

  // Stores a BRDF value [1/sr].
  void SetValue(int channel, int bin, double brdf) {
    stored[channel][bin] = brdf / kMerlScale[channel];
  }
};

// A table of `grid` where every bin is marked invalid (-1).
BrdfTable MakeInvalidTable(const std::string& source, const MerlGrid& grid);

// True where both directions are above the surface at the bin's centre. [grid.size()]
std::vector<bool> BinsAboveSurface(const MerlGrid& grid);

// True where the bin is above the surface and all three stored values are finite and >= 0
// (docs/method.md). [grid.size()]
std::vector<bool> ValidBins(const BrdfTable& table);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_BRDF_TABLE_H_
