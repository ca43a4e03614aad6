#include "trilobe/appearance/material.h"

#include <cmath>
#include <memory>

#include "trilobe/base/check.h"
#include "trilobe/evaluate/prepared_model.h"

namespace trilobe {
AngularBrdf Interpolated(const TabulatedBrdf& table) {
  return [&table](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
    return table.Interpolate(angles);
  };
}

Material Isotropic(const AngularBrdf& brdf) {
  CheckNotEmpty(brdf, "brdf");
  return {brdf, [brdf](const SphericalAngles& at) {
            return brdf(ToHalfDiff(ToDirections(at)),
                        Cosines{std::cos(at.theta_i), std::cos(at.theta_o)});
          }};
}

Material MaterialOf(const FactorModel& model) {
  const auto prepared = std::make_shared<const PreparedModel<double>>(model);
  const auto value = [prepared](const DirectionPair& pair) {
    return prepared->Value(pair.wi, pair.wo);
  };
  Material material{{}, [value](const SphericalAngles& at) { return value(ToDirections(at)); }};
  if (!model.spec().anisotropic()) {
    material.angular = [value](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
      return value(ToDirections(angles));
    };
  }
  return material;
}

}  // namespace trilobe
