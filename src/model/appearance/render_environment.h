#ifndef TRILOBE_MODEL_APPEARANCE_RENDER_ENVIRONMENT_H_
#define TRILOBE_MODEL_APPEARANCE_RENDER_ENVIRONMENT_H_

#include <functional>
#include <span>

#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/view.h"

namespace trilobe {

// Renders images for display under the environment itself, instead of under drawn lights, which
// glossy materials would show one by one. A pixel's light comes from all half vectors about its
// normal (HalfCells), with the mean of the environment over each cell. So images are as smooth as
// their material, and all materials have the same lights. The same bits for any number of threads.
RenderedImages RenderUnder(const Environment& environment, const View& view,
                           std::span<const SphericalBrdf> materials,
                           const std::function<bool(const SphericalAngles&)>& counts,
                           int num_threads);

// The same for isotropic materials on ViewSphere(size), much faster: a quarter turn about the eye's
// direction maps the sphere and its half vectors to themselves and preserves all angles, so a
// quarter of the pixels gives the materials' values at all of them.
RenderedImages RenderSphereUnder(
    const Environment& environment, int size, std::span<const AngularBrdf> materials,
    const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_RENDER_ENVIRONMENT_H_
