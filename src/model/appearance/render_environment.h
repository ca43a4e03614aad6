#ifndef TRILOBE_MODEL_APPEARANCE_RENDER_ENVIRONMENT_H_
#define TRILOBE_MODEL_APPEARANCE_RENDER_ENVIRONMENT_H_

#include <functional>
#include <span>

#include "trilobe/model/appearance/environment.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/appearance/render.h"
#include "trilobe/model/appearance/view.h"

namespace trilobe {

// What Render makes, for pictures: under the environment itself instead of points that stand for
// it, which a glossy material would show one by one. A pixel's light comes from all half vectors
// about its normal (HalfCells), a cell's being the mean of the environment over the cell. So what
// is seen is as smooth as the material is, and all materials have the same lights. The same bits
// for any number of threads.
RenderedImages RenderUnder(const Environment& environment, const View& view,
                           std::span<const SphericalBrdf> materials,
                           const std::function<bool(const SphericalAngles&)>& counts,
                           int num_threads);

// The same of isotropic materials on ViewSphere(size), much faster: turned by a quarter about the
// eye's direction a sphere and its half vectors are what they were, and so are the angles between
// them, so that a fourth of the pixels says what the materials are in all of them.
RenderedImages RenderSphereUnder(
    const Environment& environment, int size, std::span<const AngularBrdf> materials,
    const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_RENDER_ENVIRONMENT_H_
