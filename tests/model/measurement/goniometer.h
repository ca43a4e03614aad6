#ifndef TRILOBE_TESTS_MODEL_MEASUREMENT_GONIOMETER_H_
#define TRILOBE_TESTS_MODEL_MEASUREMENT_GONIOMETER_H_

#include <cmath>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// A glossy material, at a goniometer's directions: six theta_i, seventeen theta_o, each 15 degrees.
inline double Glossy(const SphericalAngles& at) {
  const HalfDiffAngles half = ToHalfDiff(ToDirections(at));
  return 0.05 + 0.02 * std::cos(half.theta_d) + 0.5 * std::exp(-half.theta_h * half.theta_h / 0.02);
}

template <typename Change>
Measurement Goniometer(const Change& change, int step_deg = 15) {
  SampleCollector collector("x.csv", "test");
  for (const double theta_i : {5.0, 15.0, 30.0, 45.0, 60.0, 70.0}) {
    for (int theta_o = 0; theta_o <= 80; theta_o += 5) {
      for (int phi = 0; phi < 360; phi += step_deg) {
        SphericalAngles at = {.theta_i = DegreesToRadians(theta_i),
                              .phi_i = 0,
                              .theta_o = DegreesToRadians(theta_o),
                              .phi_o = DegreesToRadians(phi)};
        double rho = Glossy(at);
        change(&at, &rho);
        collector.Add(at, {rho, rho, rho});
      }
    }
  }
  return collector.Take();
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_MODEL_MEASUREMENT_GONIOMETER_H_
