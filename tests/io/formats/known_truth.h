#ifndef TRILOBE_TESTS_IO_FORMATS_KNOWN_TRUTH_H_
#define TRILOBE_TESTS_IO_FORMATS_KNOWN_TRUTH_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe {

// The material that generated files of all formats hold; by its formula [1/sr], 0 below the
// surface.
inline const SynthMaterial& TrueMaterial(bool anisotropic = false) {
  return FindSynthMaterial(anisotropic ? "brushed_aluminium" : "plastic");
}

inline Rgb TrueValue(double theta_i_deg, double phi_i_deg, double theta_o_deg, double phi_o_deg,
                     bool anisotropic = false) {
  const SphericalAngles at = {DegreesToRadians(theta_i_deg), DegreesToRadians(phi_i_deg),
                              DegreesToRadians(theta_o_deg), DegreesToRadians(phi_o_deg)};
  if (!IsAboveSurface(at)) return {};
  return TrueMaterial(anisotropic).brdf(ToDirections(at));
}

// Text of a number, to as many digits as a double has.
inline std::string Text(double number) {
  std::ostringstream text;
  text.precision(17);
  text << number;
  return text.str();
}

// The keys, with one number in the place of all three where `grey`, at all samples, within a part
// in `tolerance` of the largest value.
inline void ExpectTruth(const Measurement& measurement, bool grey, bool anisotropic = false,
                        double tolerance = 1e-9) {
  ASSERT_GT(measurement.samples.size(), 0);
  for (int j = 0; j < measurement.samples.size(); ++j) {
    const Rgb truth =
        TrueMaterial(anisotropic).brdf(ToDirections(measurement.samples.directions[j]));
    for (int c = 0; c < kChannels; ++c) {
      const double expected = truth[grey ? 1 : c];
      EXPECT_NEAR(measurement.samples.rho[j][c], expected, tolerance * std::max(expected, 1.0))
          << "sample " << j << ", channel " << c;
    }
  }
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_IO_FORMATS_KNOWN_TRUTH_H_
