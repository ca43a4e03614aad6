#ifndef TRILOBE_MODEL_MEASUREMENT_SYNTH_H_
#define TRILOBE_MODEL_MEASUREMENT_SYNTH_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/measurement/albedo.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/hemisphere_grid.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/synth_material.h"

namespace trilobe {

// All synthetic materials; the first is the default (fitted by `./run`).
const std::vector<SynthMaterial>& SynthMaterials();

// Throws Error with the known names if there is none.
const SynthMaterial& FindSynthMaterial(std::string_view name);

// A simulated gonioreflectometer measurement: values have log-normal noise of relative standard
// deviation `noise`, reproducible by seed; with noise, a few grazing bins are lost (invalid), as in
// MERL files. Throws Error unless noise is in [0, 1], and for anisotropic materials, which need
// more than a MERL table.
BrdfTable Synthesize(const SynthMaterial& material, double noise, uint64_t seed,
                     const MerlGrid& grid = {}, int num_threads = 1);

// The same as scattered samples at all pairs of nodes of a grid; lost samples are missing.
Measurement SynthesizeSamples(const SynthMaterial& material, double noise, uint64_t seed,
                              const HemisphereGrid& grid, int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SYNTH_H_
