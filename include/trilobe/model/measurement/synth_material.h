#ifndef TRILOBE_MODEL_MEASUREMENT_SYNTH_MATERIAL_H_
#define TRILOBE_MODEL_MEASUREMENT_SYNTH_MATERIAL_H_

#include <string>

#include "trilobe/model/measurement/albedo.h"

namespace trilobe {

// A named synthetic material: an analytic BRDF that stands for a class of measured ones.
struct SynthMaterial {
  std::string name;
  std::string description;
  BrdfFunction brdf;         // [1/sr]; both directions above the surface
  bool anisotropic = false;  // changes when it is turned about the normal
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SYNTH_MATERIAL_H_
