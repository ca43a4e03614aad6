#ifndef TRILOBE_MODEL_MEASUREMENT_UNMEASURED_SAMPLES_H_
#define TRILOBE_MODEL_MEASUREMENT_UNMEASURED_SAMPLES_H_

#include <vector>

#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Samples of 0 in all channels where nothing was measured: beside others, of the same direction of
// light, that are not dark. Of the eight nearest samples above 0 within 30 degrees, at least four,
// the median is at least half of the lower quartile of that incidence, and three times the last
// level of the detector, the least value if that is there more than twice; and the least of them is
// at least half of this, and not all are the same. Or, whatever
// their light, zeros that nearly fill a cone of up to 20 degrees about it. None if fewer than one
// in 500 samples are such, or if more than a fifth of all samples are 0: then 0 is what dark is.
// All zeros are gaps where up to half of the samples are 0 and the darkest of the others is above a
// tenth of their median. Ascending.
std::vector<int> FindZeroGaps(const BrdfSamples& samples);

// Samples on a grid of theta_i, theta_o and phi_o - phi_i that were filled in: where a theta_i (or
// theta_o) has, in nine of ten places, to the bit the values of the one before, and these are many.
// None if half of the angles do so, as those of a white reference, or if there are fewer than five.
struct FilledSamples {
  std::vector<int> samples;      // ascending
  int theta_i = 0, theta_o = 0;  // how many angles were filled in
  int all_theta_i = 0, all_theta_o = 0;
};
FilledSamples FindFilled(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_UNMEASURED_SAMPLES_H_
