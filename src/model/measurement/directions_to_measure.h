#ifndef TRILOBE_MODEL_MEASUREMENT_DIRECTIONS_TO_MEASURE_H_
#define TRILOBE_MODEL_MEASUREMENT_DIRECTIONS_TO_MEASURE_H_

#include <span>
#include <vector>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// What a goniometer can do. All angles in radians.
struct Goniometer {
  double max_theta = DegreesToRadians(80);  // of the light and of the detector, from the normal
  bool in_plane = false;                    // the detector stays in the plane of incidence
  std::vector<double> incidences = {};      // theta_i that the light has; empty: any
  // All angles but given incidences, and 0 and pi in the plane, are multiples of it; 0: any angle.
  double step = 0;
  double blind = 0;  // least angle between the light and the detector
};

inline constexpr int kMostDirections = 100000;

// Directions to measure of an isotropic material that is not known, phi_i = 0 and phi_o from 0 to
// pi: points of low discrepancy (Halton 1960) in theta_h, theta_d and phi_d or, at given
// incidences, in theta_h, phi_h and theta_i, of which those are left out that the device cannot
// reach or has measured. Each prefix is spread as evenly, so that one may stop at any time. Throws
// Error unless count is from 1 to kMostDirections and the device reaches so many.
std::vector<SphericalAngles> DirectionsToMeasure(int count, const Goniometer& device);

// The first `most` of them that the device reaches, or as many as there are, without those that say
// the same of an isotropic material as one of `measured`, at any azimuth of the light, to a
// twentieth of a degree. Throws Error as above, but for too few.
std::vector<SphericalAngles> DirectionsLeft(int most, const Goniometer& device,
                                            std::span<const SphericalAngles> measured);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_DIRECTIONS_TO_MEASURE_H_
