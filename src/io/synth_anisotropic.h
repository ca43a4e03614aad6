#ifndef TRILOBE_IO_SYNTH_ANISOTROPIC_H_
#define TRILOBE_IO_SYNTH_ANISOTROPIC_H_

#include <vector>

#include "trilobe/io/synth.h"

namespace trilobe {

// The anisotropic ones of SynthMaterials(): woven cloths, metals and coats with a grain along x.
std::vector<SynthMaterial> AnisotropicMaterials();

}  // namespace trilobe

#endif  // TRILOBE_IO_SYNTH_ANISOTROPIC_H_
