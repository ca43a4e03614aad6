#ifndef TRILOBE_MODEL_MEASUREMENT_TABULATED_BRDF_H_
#define TRILOBE_MODEL_MEASUREMENT_TABULATED_BRDF_H_

#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// A measured table as a function of directions. An invalid bin takes the nearest valid value:
// within its (theta_h, theta_d) row by phi_d (periodic), else at the nearest theta_d, then theta_h.
// (Invalid bins need values: a bin that contains directions above the surface may have its centre
// below.)
class TabulatedBrdf {
 public:
  // Throws Error if no bin is valid.
  explicit TabulatedBrdf(const BrdfTable& table, int num_threads = 1);

  // BRDF [1/sr] of the bin that contains these directions; 0 if either is below the surface.
  Rgb operator()(const DirectionPair& directions) const;

  // The same, interpolated linearly between bin centres in sqrt(theta_h), theta_d and phi_d.
  Rgb Interpolate(const DirectionPair& directions) const;
  // For directions above the surface. Throws Error as CheckAngles does.
  Rgb Interpolate(const HalfDiffAngles& angles) const;

  // The value of a bin, or of the valid bin that replaces it.
  Rgb Value(int bin) const {
    const Colour& rho = values_[bin];
    return {rho.channel[0], rho.channel[1], rho.channel[2]};
  }

 private:
  // Channels are interleaved, since an interpolation reads eight bins that are far apart in memory.
  struct alignas(4 * sizeof(double)) Colour {
    double channel[kChannels + 1];
  };

  MerlGrid grid_;
  std::vector<Colour> values_;  // [grid.size()]
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_TABULATED_BRDF_H_
