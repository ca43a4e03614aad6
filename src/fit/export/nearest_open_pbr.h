#ifndef TRILOBE_FIT_EXPORT_NEAREST_OPEN_PBR_H_
#define TRILOBE_FIT_EXPORT_NEAREST_OPEN_PBR_H_

#include "fit/export/open_pbr.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The standard material that looks most like a model.
struct NearestOpenPbr {
  OpenPbr material;
  SphereError error;  // of a sphere that is rendered of both
};

// Finds it by Ceres' trust region under bounds from several starts (metal and dielectric, smooth
// and rough). Each start first fits the cube root of rho cos theta_i over half vectors, then a
// small sphere by CIELAB difference. The best one by the sphere that judges fits is returned.
// Directions beyond `max_theta` [rad], which were not measured, do not count. Throws Error for a
// model that reflects nothing.
NearestOpenPbr FindNearestOpenPbr(const FactorModel& model, double max_theta,
                                  const AppearanceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_EXPORT_NEAREST_OPEN_PBR_H_
