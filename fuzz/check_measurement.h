#ifndef TRILOBE_FUZZ_CHECK_MEASUREMENT_H_
#define TRILOBE_FUZZ_CHECK_MEASUREMENT_H_

#include <cmath>
#include <cstdlib>

#include "model/measurement/anisotropy.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Aborts unless scattered samples keep what readers promise of them.
inline void CheckScattered(const Measurement& measurement) {
  const BinCounts& counts = measurement.counts;
  CheckSamples(measurement.samples);
  if (measurement.table || counts.valid != measurement.samples.size() ||
      measurement.samples.directions.size() != measurement.samples.rho.size() ||
      counts.valid + counts.below_surface + counts.non_finite + counts.negative + counts.missing +
              counts.extrapolated + counts.beyond_nodes !=
          counts.total) {
    std::abort();
  }
  for (const SphericalAngles& angles : measurement.samples.directions) {
    if (!(angles.theta_i <= measurement.max_theta && angles.theta_o <= measurement.max_theta)) {
      std::abort();
    }
  }
  if (!std::isfinite(ReciprocityError(measurement).median)) std::abort();
  const double share = AnisotropyOf(measurement).share;
  if (!(share >= 0 && share <= 1 + 1e-9)) std::abort();
  Measurement limited = measurement;
  LimitAngles(1, &limited);
  if (limited.counts.valid + limited.counts.beyond_max_angle != counts.valid) std::abort();
  Measurement lit = measurement;
  LeaveOutOwnShadow(&lit);
  if (lit.counts.valid + lit.counts.below_min_theta_d != counts.valid) std::abort();
}

}  // namespace trilobe

#endif  // TRILOBE_FUZZ_CHECK_MEASUREMENT_H_
