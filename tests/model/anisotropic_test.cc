// The anisotropic model (paper eq. 4, docs/model.md): nodes, interpolation, poles, gauge.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "model/objective/gauge.h"
#include "model/objective/lobes.h"
#include "tests/error_of.h"
#include "tests/model/anisotropic_samples.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/objective/lobe_light.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

double Degrees(double x) { return DegreesToRadians(x); }

TEST(Anisotropic, HasThePapersNumberOfParameters) {
  EXPECT_EQ(ModelSpec::Anisotropic(3).num_parameters(), 2010);
}

TEST(Axis, PolarNodesAreReadAlone) {
  const Axis axis = Axis::Utia();
  for (int a = 0; a < 6; ++a) {
    for (int b = 0; b < 48; ++b) {
      for (const double turns : {0.0, 1.0, -1.0}) {
        const Stencil at = axis.At(Degrees(15 * a), Degrees(7.5 * b) + turns * 2 * kPi);
        ASSERT_EQ(at.size, 1) << a << ' ' << b;
        EXPECT_EQ(at.index[0], 48 * a + b);
        EXPECT_EQ(at.weight[0], 1);
      }
    }
  }
}

TEST(Axis, PolarReadingsAreBilinearPeriodicAndClamped) {
  const Axis axis = Axis::Utia();
  const Stencil inside = axis.At(Degrees(15 + 15 * 0.25), Degrees(352.5 + 7.5 * 0.6));
  ASSERT_EQ(inside.size, 4);
  EXPECT_NEAR(inside.WeightOf(48 + 47), 0.75 * 0.4, 1e-9);
  EXPECT_NEAR(inside.WeightOf(48 + 0), 0.75 * 0.6, 1e-9);
  EXPECT_NEAR(inside.WeightOf(2 * 48 + 47), 0.25 * 0.4, 1e-9);
  EXPECT_NEAR(inside.WeightOf(2 * 48 + 0), 0.25 * 0.6, 1e-9);
  const Stencil beyond = axis.At(Degrees(88), Degrees(15));
  ASSERT_EQ(beyond.size, 1);
  EXPECT_EQ(beyond.index[0], 5 * 48 + 2);
}

TEST(Axis, RefusesNodesThatDoNotAscendOrAreTooMany) {
  const auto spec = [](const Axis& axis) {
    ModelSpec spec = ModelSpec::Anisotropic(1);
    spec.g_axis = axis;
    return spec;
  };
  EXPECT_NO_THROW(CheckSpec(spec(Axis::Polar({0, 40, 89}, 4))));
  EXPECT_THAT(ErrorOf([&] {
                CheckSpec(spec(Axis::Polar({0, 40, 40}, 4)));
              }),
              IsError(ErrorKind::kRange, {.key = "G", .value = "40"}));
  EXPECT_THAT(ErrorOf([&] {
                CheckSpec(spec(Axis::Polar({0, 40, 90}, 4)));
              }),
              IsError(ErrorKind::kRange, {.key = "G", .value = "90"}));
  EXPECT_THAT(ErrorOf([&] {
                CheckSpec(spec(Axis::Polar({0, std::nan(""), 80}, 4)));
              }),
              IsError(ErrorKind::kRange, {.key = "G", .value = "80"}));
  EXPECT_THAT(ErrorOf([&] {
                CheckSpec(spec(Axis::Polar({-1, 40}, 4)));
              }),
              IsError(ErrorKind::kRange, {.key = "G", .value = "40"}));
  EXPECT_THAT(ErrorOf([&] { CheckSpec(spec(Axis::Polar({}, 4))); }),
              IsError(ErrorKind::kRange, {.key = "axis"}));
  EXPECT_THAT(ErrorOf([&] {
                CheckSpec(spec(Axis::Polar({0, 40}, kMaxTableSize)));
              }),
              IsError(ErrorKind::kRange, {.key = "G", .value = "4096"}));
  EXPECT_THAT(ErrorOf([&] { Axis::Utia().At(std::nan(""), 0); }),
              IsError(ErrorKind::kRange, {.key = "theta, phi"}));
  EXPECT_THAT(ErrorOf([&] { Axis::Utia().At(0, std::nan("")); }),
              IsError(ErrorKind::kRange, {.key = "theta, phi"}));
}

// Eq. 4 written out by itself.
double ReferenceValue(const FactorModel& model, const SphericalAngles& at, int c) {
  const auto bilinear = [](std::span<const double> table, double theta, double phi) {
    const double a = std::min(RadiansToDegrees(theta) / 15, 5.0);
    const double b = RadiansToDegrees(std::fmod(phi + 4 * kPi, 2 * kPi)) / 7.5;
    const int a0 = std::min(static_cast<int>(a), 4), b0 = static_cast<int>(b);
    const auto node = [&](int i, int j) { return table[48 * i + j % 48]; };
    const double s = a - a0, t = b - b0;
    return (1 - s) * ((1 - t) * node(a0, b0) + t * node(a0, b0 + 1)) +
           s * ((1 - t) * node(a0 + 1, b0) + t * node(a0 + 1, b0 + 1));
  };
  const auto direction = [](double theta, double phi) {
    return Direction{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                     std::cos(theta)};
  };
  const Direction wi = direction(at.theta_i, at.phi_i), wo = direction(at.theta_o, at.phi_o);
  Direction h{};
  for (int k = 0; k < 3; ++k) h[k] = wi[k] + wo[k];
  const double length = std::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
  const double theta_h = std::acos(std::min(h[2] / length, 1.0));
  const double phi_h = std::hypot(h[0], h[1]) < 1e-9 ? 0 : std::atan2(h[1], h[0]);
  const double theta_d = std::acos(std::min(length / 2, 1.0));
  const double d = std::clamp(RadiansToDegrees(theta_d) - 0.5, 0.0, 89.0);
  const int d0 = std::min(static_cast<int>(d), 88);
  double rho = model.d()[c];
  for (int m = 0; m < model.spec().lobes; ++m) {
    const auto F = model.F(m, c);
    rho += model.s(m)[c] * bilinear(model.D(m, c), theta_h, phi_h) *
           ((1 - (d - d0)) * F[d0] + (d - d0) * F[d0 + 1]) *
           bilinear(model.G(m, c), at.theta_i, at.phi_i) *
           bilinear(model.G(m, c), at.theta_o, at.phi_o) /
           (std::cos(at.theta_i) * std::cos(at.theta_o));
  }
  return rho;
}

TEST(Anisotropic, ValuesAreThoseOfEquation4) {
  const FactorModel model = RandomModel(ModelSpec::Anisotropic(3), 1);
  Random random(2);
  for (int k = 0; k < 2000; ++k) {
    const SphericalAngles at = {random.Uniform(0.05, 1.5), random.Uniform(-kPi, kPi),
                                random.Uniform(0.05, 1.5), random.Uniform(-kPi, kPi)};
    const Rgb value = Evaluate(model, ToDirections(at));
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(value[c] / ReferenceValue(model, at, c), 1, 1e-6) << k;
    }
  }
}

TEST(Anisotropic, ExchangedDirectionsHaveTheSameValue) {
  const ModelSpec spec = ModelSpec::Anisotropic(3);
  const FactorModel model = RandomModel(spec, 3);
  std::set<std::vector<int>> unordered;
  const BrdfSamples samples = UtiaSamples(model);
  ASSERT_EQ(samples.size(), 288 * 288);
  for (int j = 0; j < samples.size(); j += 7) {
    SphericalAngles at = samples.directions[j];
    std::swap(at.theta_i, at.theta_o);
    std::swap(at.phi_i, at.phi_o);
    const SampleStencils stencils = ScatteredStencils(spec, at);
    EXPECT_EQ(stencils.G_i.size, 1);
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(UnclampedValue(model, stencils, c) / samples.rho[j][c], 1, 1e-9) << j;
    }
  }
}

TEST(Anisotropic, TheHalfVectorAtTheNormalHasNoAzimuth) {
  const ModelSpec spec = ModelSpec::Anisotropic(1);
  // Mirror images, whose half vector is the normal but for rounding.
  for (int b = 0; b < 48; ++b) {
    const double phi = Degrees(7.5 * b);
    const SampleStencils at =
        ScatteredStencils(spec, SphericalAngles{Degrees(45), phi, Degrees(45), phi + kPi});
    ASSERT_EQ(at.D.size, 1) << b;
    EXPECT_EQ(at.D.index[0], 0) << b;
  }
}

TEST(Anisotropic, CanonicalFormsKeepValuesAndHaveTheNormsOfMethod) {
  const ModelSpec spec = ModelSpec::Anisotropic(3);
  const FactorModel model = RandomModel(spec, 4);
  const Objective objective(UtiaSamples(model), spec, FindWeighting("compressive"), 2);
  FactorModel canonical = model;
  Canonicalize(objective.coverage(), &canonical);
  EXPECT_LT(objective.Value(canonical), 1e-20 * objective.MeasuredEnergy());
  for (int m = 0; m < spec.lobes; ++m) {
    double integral = 0;
    for (int a = 0; a < 6; ++a) {
      const double t1 = Degrees(std::max(15.0 * a - 7.5, 0.0)), t2 = Degrees(15 * a + 7.5);
      for (int b = 0; b < 48; ++b) {
        integral += canonical.table(Factor::kD, m)[48 * a + b] * Degrees(7.5) *
                    (std::pow(std::sin(t2), 2) - std::pow(std::sin(t1), 2)) / 2;
      }
    }
    EXPECT_NEAR(integral, 1, 1e-12);
  }
  const LobeLight light = ComputeLobeLight(objective.coverage(), canonical);
  double sum = 0, total = 0;
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    double reflected = 0, s = 0;
    for (int k = 0; k < spec.f_axis.size; ++k) {
      const double through = light.through[canonical.TableOffset(Factor::kF, t) + k];
      sum += through * std::log(canonical.table(Factor::kF, t)[k]);
      total += through;
    }
    for (int m = 0; m < spec.lobes; ++m) {
      reflected += light.lobes[m][t];
      s += canonical.s(m)[t];
    }
    EXPECT_NEAR(4 * s / reflected, 1, 1e-12);
  }
  EXPECT_NEAR(sum / total, 0, 1e-12);
  for (int m = 0; m < spec.lobes; ++m) {
    const std::span<const double> s = canonical.s(m);
    EXPECT_NEAR(4 * (s[0] + s[1] + s[2]) / (3 * Mean(light.lobes[m])), 1, 1e-12);
  }
  for (int m = 1; m < spec.lobes; ++m) EXPECT_LE(light.Share(m), light.Share(m - 1));
  FactorModel again = canonical;
  Canonicalize(objective.coverage(), &again);
  for (size_t k = 0; k < again.parameters().size(); ++k) {
    EXPECT_EQ(again.parameters()[k], canonical.parameters()[k]);
  }
}

// A round lobe reflects as much in either model.
TEST(Anisotropic, LightIsThatOfTheSameIsotropicModel) {
  ModelSpec fine = ModelSpec::Anisotropic(1);
  std::vector<double> nodes;
  for (int k = 0; k < 60; ++k) nodes.push_back(1.5 * k);
  fine.d_axis = fine.g_axis = Axis::Polar(nodes, 8);
  FactorModel polar(fine), round(ModelSpec::SharedFactors(1));
  for (FactorModel* model : {&polar, &round}) {
    const ModelSpec& spec = model->spec();
    for (double& x : model->parameters()) x = 1;
    for (int k = 0; k < spec.d_axis.size; ++k) {
      model->table(Factor::kD, 0)[k] = std::exp(-4 * std::pow(spec.d_axis.Theta(k), 2));
    }
    for (int k = 0; k < spec.g_axis.size; ++k) {
      model->table(Factor::kG, 0)[k] = std::cos(spec.g_axis.Theta(k));
    }
  }
  const auto light = [](const FactorModel& model) {
    return ComputeLobeLight(std::vector<double>(model.parameters().size(), 1.0), model);
  };
  EXPECT_NEAR(light(polar).lobes[0][0] / light(round).lobes[0][0], 1, 0.03);
  EXPECT_NEAR(light(polar).Share(0), light(round).Share(0), 0.01);
}

TEST(Anisotropic, ASplitLobeAddsUp) {
  const FactorModel model = RandomModel(ModelSpec::Anisotropic(2), 5);
  const FactorModel split = SplitLobe(model, 1);
  ASSERT_EQ(split.spec().lobes, 3);
  for (int k = 0; k < 288; ++k) {
    EXPECT_NEAR(split.D(1, 0)[k] + split.D(2, 0)[k], model.D(1, 0)[k], 1e-12);
  }
}

TEST(Anisotropic, WantsAzimuths) {
  const ModelSpec spec = ModelSpec::Anisotropic(1);
  const auto error = [&](const BrdfSamples& samples) {
    return ErrorOf([&] { const Objective objective(samples, spec, FindWeighting("compressive")); });
  };
  const BrdfSamples on_grid = ValidSamples(RandomTable({8, 9, 10}, 1));
  EXPECT_THAT(error(on_grid),
              IsError(ErrorKind::kUnsupported,
                      {.key = "anisotropic",
                       .value = "a measurement on a MERL grid, which knows no azimuths,"}));
  EXPECT_THAT(error(Scattered(on_grid)), IsError(ErrorKind::kMissing, {.key = "directions"}));
  BrdfSamples bad = UtiaSamples(RandomModel(spec, 6));
  bad.directions[17].phi_o = std::nan("");
  EXPECT_THAT(error(bad), IsError(ErrorKind::kRange, {.key = "sample 17", .value = "directions"}));
}

TEST(Anisotropic, ThinnedSamplesStillTouchEveryNode) {
  const ModelSpec spec = ModelSpec::Anisotropic(1);
  const BrdfSamples samples = UtiaSamples(RandomModel(spec, 7));
  for (const int stride : {2, 3, 6, 12, 24}) {
    const BrdfSamples thinned = Thinned(samples, stride);
    EXPECT_NEAR(thinned.size() * 1.0 * stride / samples.size(), 1, 0.01);
    const Objective all(samples, spec, FindWeighting("compressive"), 2);
    const Objective few(thinned, spec, FindWeighting("compressive"), 2);
    for (size_t k = 0; k < all.coverage().size(); ++k) {
      EXPECT_EQ(all.coverage()[k] > 0, few.coverage()[k] > 0) << k << " by " << stride;
    }
  }
}

// If no sample reads the horizon, the canonical form continues cos theta / G to it, linearly in
// cos theta, up to three times as far as it is or as low.
TEST(Anisotropic, GContinuesToTheHorizon) {
  const double end = DegreesToRadians(75);
  const ModelSpec spec = ModelSpec::AnisotropicFor(1, 8, end);
  ASSERT_TRUE(spec.g_axis.reaches_horizon());
  EXPECT_FALSE(ModelSpec::AnisotropicFor(1, 8, DegreesToRadians(80)).g_axis.reaches_horizon());
  EXPECT_FALSE(ModelSpec::Anisotropic(1).g_axis.reaches_horizon());
  FactorModel model(spec);
  for (double& x : model.parameters()) x = 1;
  std::vector<double> coverage(spec.num_parameters(), 1);
  const int phis = spec.g_axis.phi_nodes, rings = spec.g_axis.size / phis;
  const int begin = model.TableOffset(Factor::kG, 0);
  // G / cos theta grows, falls and stays from the ring before the last on; at last it leaps.
  ASSERT_EQ(phis, 4);
  constexpr double kGrowth[] = {1.5, 0.5, 1, 100};
  const double before = DegreesToRadians(60);
  for (int b = 0; b < phis; ++b) {
    for (const int ring : {rings - 2, rings - 1}) coverage[begin + ring * phis + b] = 0;
    double* const G = model.parameters().data() + begin;
    G[(rings - 3) * phis + b] =
        G[(rings - 4) * phis + b] / std::cos(before) * std::cos(end) * kGrowth[b];
  }
  Canonicalize(coverage, &model);
  const std::span<const double> G = model.G(0, 0);
  for (int b = 0; b < phis; ++b) {
    const auto ratio = [&](double theta) {
      return spec.g_axis.At(theta, spec.g_axis.Phi(b))(G) / std::cos(theta);
    };
    for (const double degrees : {84.0, 89.9}) {
      const double theta = DegreesToRadians(degrees);
      const double slope =
          (1 / ratio(before) - 1 / ratio(end)) / (std::cos(before) - std::cos(end));
      const double linear = 1 / ratio(end) + slope * (std::cos(theta) - std::cos(end));
      const double bounded = std::clamp(linear * ratio(end), 1.0 / 3, 3.0) / ratio(end);
      EXPECT_NEAR(ratio(theta) * bounded, 1, 1e-9) << degrees << " " << b;
    }
    // Between these rings as well no BRDF runs away.
    for (double degrees = 75; degrees < 89.9; ++degrees) {
      const double growth = ratio(DegreesToRadians(degrees)) / ratio(end);
      EXPECT_GT(growth, 0.3) << degrees << " " << b;
      EXPECT_LT(growth, 3.2) << degrees << " " << b;
    }
  }
}

// Sums of samples keep entries of a stencil apart.
TEST(Anisotropic, OfOneAzimuthNoEntryIsReadTwice) {
  const Axis axis = Axis::Polar({0, 30, 60}, 1);
  for (const double phi : {0.0, 0.3, 3.0, -2.0}) {
    const Stencil between = axis.At(DegreesToRadians(15), phi);
    EXPECT_EQ(between.size, 2) << phi;
    EXPECT_NEAR(between.WeightOf(0), 0.5, 1e-12) << phi;
    EXPECT_NEAR(between.WeightOf(1), 0.5, 1e-12) << phi;
    EXPECT_EQ(axis.At(DegreesToRadians(60), phi).size, 1) << phi;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
