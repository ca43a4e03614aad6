#ifndef TRILOBE_TESTS_MODEL_MATERIALS_H_
#define TRILOBE_TESTS_MODEL_MATERIALS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// A model whose tables are those of an analytic material: GGX distributions, lobe by lobe twice as
// wide and half as strong, Schlick's F, Smith's G; tinted, with a diffuse term. Anisotropic ones
// are three times as wide across x.
inline FactorModel AnalyticModel(const ModelSpec& spec, double roughness, double diffuse) {
  FactorModel model(spec);
  for (int c = 0; c < kChannels; ++c) model.d()[c] = diffuse * (1 - 0.3 * c) / kPi;
  for (int m = 0; m < spec.lobes; ++m) {
    for (int c = 0; c < kChannels; ++c) {
      const double alpha = std::min(roughness * std::pow(2.0, m), 0.9);
      model.s(m)[c] = 0.25 * std::pow(0.5, m) * (1 - 0.1 * c);
      const auto fill = [&](Factor factor, const auto& value) {
        const Axis& axis = spec.axis(factor);
        const std::span<double> table = model.table(factor, spec.table(factor, m, c));
        for (int e = 0; e < axis.size; ++e) table[e] = value(axis.Theta(e), axis.Phi(e));
      };
      fill(Factor::kD, [&](double theta, double phi) {
        const double across = spec.d_axis.polar() ? std::min(3 * alpha, 0.9) : alpha;
        const double x = std::tan(theta) * std::cos(phi) / alpha;
        const double y = std::tan(theta) * std::sin(phi) / across;
        const double cos2 = std::pow(std::cos(theta), 2), t = 1 + x * x + y * y;
        return 1 / (kPi * alpha * across * cos2 * cos2 * t * t);
      });
      fill(Factor::kF,
           [&](double theta, double) { return 0.1 + 0.9 * std::pow(1 - std::cos(theta), 5); });
      fill(Factor::kG, [&](double theta, double) {
        const double tangent = alpha * std::tan(std::min(theta, 1.57));
        return 2 / (1 + std::sqrt(1 + tangent * tangent));
      });
    }
  }
  return model;
}

inline Direction DirectionAt(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

struct NamedModel {
  std::string name;
  FactorModel model;
};

// Materials of every form of model: from mirror-like to rough, with and without a diffuse term.
inline std::vector<NamedModel> TestMaterials() {
  constexpr MerlGrid kFine;
  std::vector<NamedModel> materials;
  const auto add = [&](const std::string& name, const ModelSpec& spec, double roughness,
                       double diffuse) {
    materials.push_back({name, AnalyticModel(spec, roughness, diffuse)});
  };
  add("mirror-like", ModelSpec::SharedFactors(1, kFine), 0.01, 0);
  add("metal", ModelSpec::SharedFactors(3, kFine), 0.08, 0);
  add("plastic", ModelSpec::SharedFactors(3, kFine), 0.1, 0.4);
  add("rough", ModelSpec::SharedFactors(2, kFine), 0.5, 0.1);
  add("diffuse alone", ModelSpec::SharedFactors(0, kFine), 0, 0.5);
  add("nothing shared", ModelSpec::IndependentG(kFine), 0.2, 0.2);
  ModelSpec stretched = ModelSpec::SharedFactors(2, kFine);
  stretched.stretches = Stretch{.along = -0.6, .across = 0.9};
  add("stretched", stretched, 0.1, 0.1);
  stretched.stretches = Stretches(std::vector<Stretch>{{2, 2}, {-2, -2}});
  add("stretched to the limits", stretched, 0.1, 0);
  add("eight lobes of few bins", ModelSpec::SharedFactors(8, {.theta_h = 12, .theta_d = 6}), 0.1,
      0.1);
  add("anisotropic", ModelSpec::Anisotropic(3), 0.2, 0.2);
  add("brushed", ModelSpec::AnisotropicFor(2, 48, kPi / 2.4), 0.12, 0);
  materials.push_back(
      {"random numbers",
       RandomModel(ModelSpec::SharedFactors(3, {.theta_h = 30, .theta_d = 30}), 1)});
  return materials;
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_MODEL_MATERIALS_H_
