#include "trilobe/model/appearance/material.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "trilobe/core/base/check.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe {
namespace {

// An anisotropic model at angles, not vectors as in PreparedModel: at the normal, samples
// distinguish nodes by their azimuth. Same as ScatteredStencils with half the arc functions: |wi +
// wo| = 2 cos theta_d.
Rgb EvaluateByAngles(const FactorModel& model, const SphericalAngles& at) {
  const ModelSpec& spec = model.spec();
  const DirectionPair pair = ToDirections(at);
  if (!(spec.d_axis.polar() && spec.g_axis.polar())) return Evaluate(model, pair);
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
  if (model.spec().anisotropic()) {
    const auto copy = std::make_shared<const FactorModel>(model);
    return {{}, [copy](const SphericalAngles& at) { return EvaluateByAngles(*copy, at); }};
  }
  const auto prepared = std::make_shared<const PreparedModel<double>>(model);
  return {[prepared](const HalfDiffAngles& angles, const Cosines& cosines) {
            return prepared->Value(angles, cosines);
          },
          [prepared](const SphericalAngles& at) {
            const auto [wi, wo] = ToDirections(at);
            return prepared->Value(wi, wo);
          }};
}

}  // namespace trilobe
