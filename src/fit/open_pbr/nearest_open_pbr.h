#ifndef TRILOBE_FIT_OPEN_PBR_NEAREST_OPEN_PBR_H_
#define TRILOBE_FIT_OPEN_PBR_NEAREST_OPEN_PBR_H_

#include "fit/open_pbr/open_pbr.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The standard material that looks most like a model.
struct NearestOpenPbr {
  OpenPbr material;
  SphereError error;  // of a sphere that is rendered of both
};

// Its parameters are moved, by Ceres' trust region under bounds, from some starts (a metal, a
// dielectric, smooth and rough): first until the BRDF is near, by the cube root of rho cos theta_i
// over half vectors, then until a small sphere is, by CIELAB; the best of these by the sphere that
// fits are judged by. `max_theta` [rad]: directions beyond it, which were not measured, do not
// count. Throws Error for a model that reflects nothing.
NearestOpenPbr FindNearestOpenPbr(const FactorModel& model, double max_theta,
                                  const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_OPEN_PBR_NEAREST_OPEN_PBR_H_
