#ifndef TRILOBE_MODEL_APPEARANCE_SEEN_SAMPLES_H_
#define TRILOBE_MODEL_APPEARANCE_SEEN_SAMPLES_H_

#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// How measured and fitted samples differ to the eye where they make no picture: each is a patch
// under a light of its own, as bright as rho cos theta_i. As a camera sets itself, the exposure is
// that of which the mean luminance of the measured ones, clipped at 1, is kMeanLuminance, or nearly
// 1 where so many are black that none is; 0 for a black measurement. `fitted`: [samples.size()]
SeenError CompareSamples(const BrdfSamples& samples, const std::vector<Rgb>& fitted);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_SEEN_SAMPLES_H_
