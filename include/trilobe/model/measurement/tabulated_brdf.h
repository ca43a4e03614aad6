#ifndef TRILOBE_MODEL_MEASUREMENT_TABULATED_BRDF_H_
#define TRILOBE_MODEL_MEASUREMENT_TABULATED_BRDF_H_

#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// A measured table as a function of directions. An invalid bin takes the value of the nearest valid
// one: in its own (theta_h, theta_d) row over phi_d, which wraps around; else at the nearest
// theta_d, then the nearest theta_h. (Such bins must have a value: the bin that contains two
// directions above the surface may have its centre below it.)
class TabulatedBrdf {
 public:
  // Throws Error when no bin is valid.
  explicit TabulatedBrdf(const BrdfTable& table, int num_threads = 1);

  // BRDF [1/sr] of the bin that contains these directions; 0 where either is below the surface.
  Rgb operator()(const DirectionPair& directions) const;

  // The same, linear between bin centres in sqrt(theta_h), theta_d and phi_d.
  Rgb Interpolate(const DirectionPair& directions) const;
  // Of two directions above the surface. Throws Error as CheckAngles does.
  Rgb Interpolate(const HalfDiffAngles& angles) const;

  // Of a bin, or the valid one that stands for it.
  Rgb Value(int bin) const {
    const Colour& rho = values_[bin];
    return {rho.channel[0], rho.channel[1], rho.channel[2]};
  }

 private:
  // The channels side by side: a place between bins reads eight of them, which lie far apart.
  struct alignas(4 * sizeof(double)) Colour {
    double channel[kChannels + 1];
  };

  MerlGrid grid_;
  std::vector<Colour> values_;  // [grid.size()]
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_TABULATED_BRDF_H_
