#ifndef TRILOBE_MODEL_SYNTH_SYNTH_ANISOTROPIC_H_
#define TRILOBE_MODEL_SYNTH_SYNTH_ANISOTROPIC_H_

#include <vector>

#include "trilobe/model/synth/synth_material.h"

namespace trilobe {

// The anisotropic ones of SynthMaterials(): woven cloths, metals and coats with a grain along x.
std::vector<SynthMaterial> AnisotropicMaterials();

}  // namespace trilobe

#endif  // TRILOBE_MODEL_SYNTH_SYNTH_ANISOTROPIC_H_
