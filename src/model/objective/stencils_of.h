#ifndef TRILOBE_MODEL_OBJECTIVE_STENCILS_OF_H_
#define TRILOBE_MODEL_OBJECTIVE_STENCILS_OF_H_

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Stencils by which a sample reads the tables of a model with this spec.
inline SampleStencils StencilsOf(const ModelSpec& spec, const BrdfSamples& samples, int j) {
  if (samples.on_grid()) return GridStencils(spec, samples.grid, samples.bins[j]);
  return spec.anisotropic() ? ScatteredStencils(spec, samples.directions[j])
                            : ScatteredStencils(spec, samples.Angles(j));
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_STENCILS_OF_H_
