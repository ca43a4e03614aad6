#ifndef TRILOBE_IO_SYNTH_H_
#define TRILOBE_IO_SYNTH_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/brdf/brdf_table.h"
#include "trilobe/brdf/channels.h"
#include "trilobe/brdf/directions.h"
#include "trilobe/brdf/merl_grid.h"

namespace trilobe {

// A named synthetic material: an analytic BRDF that stands for a class of measured ones.
struct SynthMaterial {
  std::string name;
  std::string description;
  Rgb (*brdf)(const DirectionPair&) = nullptr;  // [1/sr]; both directions above the surface
};

// All of them, the default one (that `./run` fits) first.
const std::vector<SynthMaterial>& SynthMaterials();

// Throws Error that lists the known names.
const SynthMaterial& FindSynthMaterial(std::string_view name);

// A measurement of it as a gonioreflectometer would give it: each value multiplied by log-normal
// noise of relative standard deviation `noise`, the same for the same seed; with
// noise, also a few grazing bins are lost (invalid), as in the MERL files.
// Throws Error unless noise is in [0, 1].
BrdfTable Synthesize(const SynthMaterial& material, double noise, uint64_t seed,
                     const MerlGrid& grid = {}, int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_IO_SYNTH_H_
