#ifndef TRILOBE_MODEL_APPEARANCE_MATERIAL_H_
#define TRILOBE_MODEL_APPEARANCE_MATERIAL_H_

#include <functional>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {

// BRDF [1/sr] of an isotropic material by the angles of two directions above the surface.
using AngularBrdf = std::function<Rgb(const HalfDiffAngles&, const Cosines&)>;

// The same for any material; phi is measured from its x towards its y.
using SphericalBrdf = std::function<Rgb(const SphericalAngles&)>;

// A measurement, linear between bin centres. Keeps a reference to `table`.
AngularBrdf Interpolated(const TabulatedBrdf& table);

// A material to render. `angular`, which is faster, is empty for anisotropic materials.
struct Material {
  AngularBrdf angular;
  SphericalBrdf spherical;
};
Material Isotropic(const AngularBrdf& brdf);
// A material from a copy of the model. Throws Error unless all parameters are finite and >= 0.
Material MaterialOf(const FactorModel& model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_MATERIAL_H_
