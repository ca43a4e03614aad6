#ifndef TRILOBE_MODEL_APPEARANCE_SPHERE_H_
#define TRILOBE_MODEL_APPEARANCE_SPHERE_H_

#include <functional>
#include <span>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {

// One sphere an isotropic material, all under the same lights, in size^2 pixels, whose sides it
// touches: what Render makes of them, faster. Pairs of directions for which `counts` is false are
// left out of all spheres. Of the pixels one in `every`, evenly spread; the others are as those
// beside the sphere. The same bits for any number of threads.
std::vector<RenderedImage> RenderSpheres(
    std::span<const AngularBrdf> materials, std::span<const Light> lights, int size,
    const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts, int num_threads,
    int every = 1);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_SPHERE_H_
