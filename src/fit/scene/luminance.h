#ifndef TRILOBE_FIT_SCENE_LUMINANCE_H_
#define TRILOBE_FIT_SCENE_LUMINANCE_H_

#include "trilobe/core/geometry/channels.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// The samples in grey: all three channels are the luminance.
BrdfSamples LuminanceOf(BrdfSamples samples);

// The model in grey, whose values are the luminance of the model's. F becomes one table a lobe,
// sum_C y_C s_C F_C, so D and G must be shared by the channels; throws Error if they are not.
FactorModel LuminanceOf(const FactorModel& model);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_LUMINANCE_H_
