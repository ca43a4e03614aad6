#ifndef TRILOBE_MODEL_MEASUREMENT_OWN_SHADOW_H_
#define TRILOBE_MODEL_MEASUREMENT_OWN_SHADOW_H_

#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// A detector near the direction of the light shades the sample: the highlight seems to vanish at
// small theta_d, although no material changes much there. This is a fault of the instrument, and a
// fit of it has a black point in each highlight. Interference coats may look the same at one
// wavelength.
struct OwnShadow {
  double theta_d_deg = 0;  // whole degrees: the shadow ends below it; 0: no shadow
  double darker = 1;       // how many times darker the highlight is in its middle
};

// Finds the shadow in the highlight of scattered samples, theta_h below 2 degrees. Samples with
// theta_d below 5 degrees are compared with the median of at least three samples with theta_d from
// 20 to 30 and the same theta_h or up to half a degree more, where a highlight is not brighter.
// There is a shadow if the median ratio of at least ten samples is below a quarter. Going down from
// theta_d = 20 degrees, it ends where fewer than four of five of the next ten samples, or of all
// samples of a degree, exceed half of the light at their theta_h, within a quarter of a degree;
// never below 5.
OwnShadow FindOwnShadow(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_OWN_SHADOW_H_
