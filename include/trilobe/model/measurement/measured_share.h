#ifndef TRILOBE_MODEL_MEASUREMENT_MEASURED_SHARE_H_
#define TRILOBE_MODEL_MEASUREMENT_MEASURED_SHARE_H_

#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// The share of what a renderer reads that was measured, 0 to 1: of all pairs of directions, with
// light from everywhere on a convex object, d mu = cos theta_i cos theta_o d omega_i d omega_o.
//
// On a grid a pair is measured if its bin is. Scattered samples measure what is within reach: pairs
// with theta_i and theta_o within 7.5 degrees of a sample's, exchanged or not, and the azimuth
// between them within 15 degrees over the sine of the smaller angle. That is half the step of
// UTIA's directions, and what lies between them is interpolated; narrower highlights need more.
double MeasuredShare(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_MEASURED_SHARE_H_
