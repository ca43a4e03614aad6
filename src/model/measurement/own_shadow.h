#ifndef TRILOBE_MODEL_MEASUREMENT_OWN_SHADOW_H_
#define TRILOBE_MODEL_MEASUREMENT_OWN_SHADOW_H_

#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Where a detector comes near the light it stands in its own light: the highlight seems to be gone
// at a small theta_d, though no material's changes much there. That part of a measurement is the
// instrument, and a fit of it has a black point in the middle of each highlight. Interference
// coats may do the same at one wavelength.
struct OwnShadow {
  double theta_d_deg = 0;  // whole degrees: the shadow ends below it; 0 where there is none
  double darker = 1;       // how many times darker the highlight is in its middle
};

// The shadow in scattered samples of the highlight, theta_h below 2 degrees. Those of theta_d below
// 5 are held against the median of those of theta_d from 20 to 30, at least three, whose theta_h
// is the same or up to half a degree larger, where no highlight is brighter: there is a shadow
// where the median of the ratio is below a quarter, of at least ten samples. Going down from 20
// degrees of theta_d, it ends where less than four of five of the ten samples next below, or of all
// those of a degree, are above half of the light at their own theta_h, within a quarter of a
// degree; never below 5.
OwnShadow FindOwnShadow(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_OWN_SHADOW_H_
