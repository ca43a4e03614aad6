#ifndef TRILOBE_FIT_EXPORT_NEAREST_OPEN_PBR_H_
#define TRILOBE_FIT_EXPORT_NEAREST_OPEN_PBR_H_

#include "fit/export/open_pbr.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe {

// Who shades a standard material: MaterialX and Blender; glTF's renderers (GltfBrdf), which have no
// rough diffuse term and lose light that is scattered more than once; or USD's preview, which does
// as these and has no tint, anisotropy and coat.
enum class StandardShading { kOpenPbr, kGltf, kPreviewSurface };

// BRDF [1/sr] of a standard material as it is shaded.
BrdfFunction StandardBrdf(StandardShading shading, const OpenPbr& material);

// The standard material that looks most like a model.
struct NearestOpenPbr {
  OpenPbr material;
  SphereError error;  // of a sphere that is rendered of both
};

// Finds it by Ceres' trust region under bounds from several starts (metal and dielectric, smooth
// and rough). Each start first fits the cube root of rho cos theta_i over half vectors, then a
// small sphere by CIELAB difference. The best one by the sphere that judges fits has all closures;
// returned is the one with the fewest (a metal, a dielectric, both, a tint, a rough diffuse term, a
// coat) that is no more than 0.5 dB behind it, or cannot be told from the model. Directions beyond
// `max_theta` [rad], which were not measured, do not count. Throws Error for a model that reflects
// nothing.
NearestOpenPbr FindNearestOpenPbr(const FactorModel& model, double max_theta,
                                  const AppearanceOptions& options,
                                  StandardShading shading = StandardShading::kOpenPbr);

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_NEAREST_OPEN_PBR_H_
