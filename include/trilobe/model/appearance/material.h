#ifndef TRILOBE_MODEL_APPEARANCE_MATERIAL_H_
#define TRILOBE_MODEL_APPEARANCE_MATERIAL_H_

#include <functional>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {

// BRDF [1/sr] of an isotropic material for two directions above the surface, by their angles.
using AngularBrdf = std::function<Rgb(const HalfDiffAngles&, const Cosines&)>;

// The same of any material, phi being from its x towards its y.
using SphericalBrdf = std::function<Rgb(const SphericalAngles&)>;

// A measurement, linear between bin centres. Keeps a reference to `table`.
AngularBrdf Interpolated(const TabulatedBrdf& table);

// A material to be rendered. Anisotropic ones have no `angular`, which is faster.
struct Material {
  AngularBrdf angular;
  SphericalBrdf spherical;
};
Material Isotropic(const AngularBrdf& brdf);
// A model as it is now. Throws Error for parameters that are not finite and 0 or more.
Material MaterialOf(const FactorModel& model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_MATERIAL_H_
