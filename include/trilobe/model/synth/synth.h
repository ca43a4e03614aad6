#ifndef TRILOBE_MODEL_SYNTH_SYNTH_H_
#define TRILOBE_MODEL_SYNTH_SYNTH_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/core/geometry/merl_grid.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/synth/synth_material.h"

namespace trilobe {

// All of them, the default one (that `./run` fits) first.
const std::vector<SynthMaterial>& SynthMaterials();

// Throws Error that lists the known names.
const SynthMaterial& FindSynthMaterial(std::string_view name);

// A measurement of it as a gonioreflectometer would give it: each value multiplied by log-normal
// noise of relative standard deviation `noise`, the same for the same seed; with
// noise, also a few grazing bins are lost (invalid), as in the MERL files.
// Throws Error unless noise is in [0, 1], and for anisotropic materials, which do not fit a MERL
// table.
BrdfTable Synthesize(const SynthMaterial& material, double noise, uint64_t seed,
                     const MerlGrid& grid = {}, int num_threads = 1);

// The same as scattered samples, at all pairs of nodes of a grid; what is lost is missing.
Measurement SynthesizeSamples(const SynthMaterial& material, double noise, uint64_t seed,
                              const HemisphereGrid& grid, int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_SYNTH_SYNTH_H_
