#include "trilobe/appearance/material.h"

#include <algorithm>
#include <cmath>

#include "trilobe/base/check.h"
#include "trilobe/lobes/continuous_model.h"

namespace trilobe {
namespace {

// As ScatteredStencils has it, with half of its arc functions: |wi + wo| = 2 cos theta_d.
Rgb EvaluatePolar(const FactorModel& model, const SphericalAngles& at) {
  const ModelSpec& spec = model.spec();
  const DirectionPair pair = ToDirections(at);
  const auto& [wi, wo] = pair;
  const double cosine = Dot(wi, wo);
  const PolarAngles half = HalfVector(pair);
  const SampleStencils stencils = {
      .D = spec.d_axis.At(half.theta, half.phi),
      .F = spec.f_axis.At(std::acos(std::sqrt(std::clamp((1 + cosine) / 2, 0.0, 1.0))), 0),
      .G_i = spec.g_axis.At(at.theta_i, at.phi_i),
      .G_o = spec.g_axis.At(at.theta_o, at.phi_o),
      .inverse_cosines = 1 / (wi[2] * wo[2])};
  return EvaluateAt(model, stencils);
}

}  // namespace

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
  if (!model.spec().anisotropic()) return Isotropic(ContinuousModel(model));
  if (model.spec().d_axis.polar() && model.spec().g_axis.polar()) {
    return {{}, [&model](const SphericalAngles& at) { return EvaluatePolar(model, at); }};
  }
  return {{}, [&model](const SphericalAngles& at) { return Evaluate(model, ToDirections(at)); }};
}

}  // namespace trilobe
