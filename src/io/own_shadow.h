#ifndef TRILOBE_IO_OWN_SHADOW_H_
#define TRILOBE_IO_OWN_SHADOW_H_

#include "trilobe/brdf/brdf_samples.h"

namespace trilobe {

// Where a detector comes near the light it stands in its own light: the highlight seems to be gone
// at a small theta_d, though no material's changes much there. That part of a measurement is the
// instrument, and a fit of it has a black point in the middle of each highlight.
struct OwnShadow {
  double theta_d_deg = 0;  // whole degrees: the shadow ends below it; 0 where there is none
  double darker = 1;       // how many times darker the highlight is in its middle
};

// The shadow in scattered samples with directions. The highlight, theta_h below 2 degrees, is held
// against itself at theta_d from 20 to 30 degrees, at equal theta_h. There is a shadow where the
// median of the ratio is below a quarter for theta_d below 5; it ends where, from there on, four of
// five samples have more than half. Without ten samples below 5 degrees there is none.
OwnShadow FindOwnShadow(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_IO_OWN_SHADOW_H_
