#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "fit/finish/light_bounds.h"
#include "fit/finish/limit_light.h"
#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/fit/fit.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// The largest directional albedo at half degrees of theta, and so many azimuths.
double Peak(const FactorModel& model, int azimuths = 1, int first = 0) {
  std::vector<LightBound> bounds;
  for (int k = first; k < 180; ++k) {
    for (int b = 0; b < azimuths; ++b) {
      bounds.push_back({{DegreesToRadians(0.5 * k), 2 * kPi * b / azimuths}, {}});
    }
  }
  double peak = 0;
  for (const Rgb& albedo : AlbedosFrom(bounds, model, 2)) {
    peak = std::max(peak, std::ranges::max(albedo));
  }
  return peak;
}

// GGX (Walter et al. 2007) with Schlick's Fresnel factor, over a diffuse base.
struct Ggx {
  double roughness, F0, diffuse;

  double operator()(const SphericalAngles& at) const {
    const DirectionPair pair = ToDirections(at);
    const HalfDiffAngles angles = ToHalfDiff(pair);
    const double a = roughness * roughness;
    const auto lambda = [a](double theta) {
      return (std::sqrt(1 + a * std::pow(std::tan(theta), 2)) - 1) / 2;
    };
    const double D = a / (kPi * std::pow(std::pow(std::cos(angles.theta_h), 2) * (a - 1) + 1, 2));
    const double F = F0 + (1 - F0) * std::pow(1 - std::cos(angles.theta_d), 5);
    return diffuse / kPi + D * F / (1 + lambda(at.theta_i) + lambda(at.theta_o)) /
                               (4 * std::cos(at.theta_i) * std::cos(at.theta_o));
  }
};

Measurement List() { return {.source = "list", .kind = "scattered samples"}; }

void Add(const SphericalAngles& at, double rho, Measurement* list) {
  list->samples.directions.push_back(at);
  list->samples.angles.push_back(ToHalfDiff(ToDirections(at)));
  list->samples.rho.push_back({rho, 0.9 * rho, 0.7 * rho});
  list->max_theta = std::max({list->max_theta, at.theta_i, at.theta_o});
}

SphericalAngles Degrees(double theta_i, double theta_o, double phi) {
  return {DegreesToRadians(theta_i), 0, DegreesToRadians(theta_o), DegreesToRadians(phi)};
}

FactorModel FitOf(const Measurement& measurement) {
  return Fit(measurement, {.compare = false}).model();
}

// A metal with a narrow highlight, in the plane and beside it.
Measurement MetalToForty() {
  Measurement list = List();
  for (const double theta_i : {0.0, 20.0, 40.0}) {
    for (int theta_o = 0; theta_o <= 40; theta_o += 2) {
      for (const double phi : {0.0, 90.0, 170.0, 180.0}) {
        const SphericalAngles at = Degrees(theta_i, theta_o, phi);
        Add(at, Ggx{0.12, 0.6, 0.01}(at), &list);
      }
    }
  }
  return list;
}

TEST(LightPromise, OfThreeIncidencesOfAMetal) { EXPECT_LE(Peak(FitOf(MetalToForty())), 1.002); }

Measurement HighlightAlone() {
  Measurement list = List();
  for (int theta_i = 0; theta_i <= 60; theta_i += 15) {
    for (int off = -12; off <= 12; off += 2) {
      for (int phi = 168; phi <= 192; phi += 4) {
        const SphericalAngles at = Degrees(theta_i, std::abs(theta_i + off), phi);
        if (ToHalfDiff(ToDirections(at)).theta_h > DegreesToRadians(6)) continue;
        Add(at, Ggx{0.2, 0.8, 0}(at), &list);
      }
    }
  }
  return list;
}

TEST(LightPromise, OfAHighlightAlone) {
  const FitResult fit = Fit(HighlightAlone(), {.compare = false});
  EXPECT_LE(Peak(fit.model()), 1.002);
  EXPECT_LT(fit.score.relative_objective, 1e-4);  // 7e-4 where G alone is lowered
}

// The azimuths of light and eye vary, so that the fit is anisotropic.
TEST(LightPromise, OfAHundredRandomDirectionsOfACloth) {
  Measurement list = List();
  list.anisotropic = true;
  std::mt19937_64 random(7);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  for (int k = 0; k < 100; ++k) {
    const auto theta = [&] { return DegreesToRadians(80) * std::sqrt(uniform()); };
    const SphericalAngles at = {theta(), 2 * kPi * uniform(), theta(), 2 * kPi * uniform()};
    Add(at, Ggx{0.6, 0.04, 0.4}(at), &list);
  }
  const FactorModel model = FitOf(list);
  EXPECT_LE(Peak(model, 24, 172), 1.002);
  EXPECT_LE(Peak(model, 1, 100), 1.002);
}

TEST(LightPromise, OfATableThatEndsAtForty) {
  SourceOptions options;
  options.max_angle_deg = 40;
  EXPECT_LE(Peak(FitOf(Source("synth:aluminium@45x45x30").Read(options))), 1.002);
}

// G glows along one azimuth, between those at each 30 degrees.
TEST(LightPromise, BetweenAzimuths) {
  FactorModel model(ModelSpec::AnisotropicFor(1, 48, DegreesToRadians(75)));
  std::ranges::fill(model.parameters(), 1.0);
  std::ranges::fill(model.d(), 0.05);
  std::ranges::fill(model.s(0), 1.0);
  const ModelSpec& spec = model.spec();
  for (int k = 0; k < spec.d_axis.size; ++k) {
    model.table(Factor::kD, 0)[k] = std::exp(-30 * std::pow(std::sin(spec.d_axis.Theta(k)), 2));
  }
  for (int k = 0; k < spec.g_axis.size; ++k) {
    const double steep = std::pow(std::sin(spec.g_axis.Theta(k)), 40);
    const double turn = std::remainder(spec.g_axis.Phi(k) - DegreesToRadians(15), kPi);
    model.table(Factor::kG, 0)[k] =
        std::cos(spec.g_axis.Theta(k)) * (0.6 + (std::abs(turn) < 0.01 ? 100 * steep : 0));
  }
  ASSERT_GT(Peak(model, 24, 172), 1.3);
  Measurement list = List();
  for (int theta_i = 0; theta_i <= 70; theta_i += 10) {
    for (int theta_o = 0; theta_o <= 70; theta_o += 10) {
      for (int phi = 0; phi < 360; phi += 30) {
        Add(Degrees(theta_i, theta_o, phi), 0, &list);
        list.samples.rho.back() = Evaluate(model, ToDirections(list.samples.directions.back()));
      }
    }
  }
  const Objective data(list.samples, spec, FindWeighting("appearance"), 1);
  const TableLayout layout = TableLayout::Full(spec);
  const LightLimit limit(data, model);
  EXPECT_EQ(limit.everywhere(), (Rgb{1, 1, 1}));
  EXPECT_TRUE(limit.Keep(data, layout, {}, &model));
  EXPECT_LE(Peak(model, 24, 172), 1.002);
  EXPECT_FALSE(limit.Keep(data, layout, {}, &model));
  EXPECT_LT(data.Value(model), 1e-4 * data.MeasuredEnergy());
}

// An isotropic metal up to 80 degrees, by an anisotropic model whose G ends at 75: it is given
// rings that can be lower.
TEST(LightPromise, WhereGEndsBeforeTheData) {
  Measurement copper = LoadMeasurement("synth:copper@9x12", {.noise = 0.02});
  copper.azimuths_matter = true;
  FitOptions options;
  options.solver_options = [](const ModelSpec& /*spec*/) {
    return SolverOptions{.max_iterations = 4};
  };
  options.compare = false;
  options.form.lobes = 1;
  const FitResult fit = Fit(copper, options);
  ASSERT_TRUE(fit.model().spec().anisotropic());
  EXPECT_LE(Peak(fit.model(), 24, 172), 1.002);
  options.raw = true;  // without the limit
  EXPECT_GT(Peak(Fit(copper, options).model(), 24, 172), 1.1);
}

Measurement Times(double k, Measurement list) {
  for (Rgb& rho : list.samples.rho) {
    for (double& x : rho) x *= k;
  }
  return list;
}

// Values of k times the samples are fitted by k times the model, over seven decades.
TEST(LightPromise, OfOtherUnits) {
  Measurement list = List();
  for (const double theta_i : {5.0, 30.0, 55.0, 70.0}) {
    for (int theta_o = 0; theta_o <= 80; theta_o += 8) {
      for (const double phi : {0.0, 60.0, 120.0, 180.0}) {
        const SphericalAngles at = Degrees(theta_i, theta_o, phi);
        Add(at, Ggx{0.25, 0.05, 0.1}(at), &list);
      }
    }
  }
  FitOptions options;
  options.compare = false;
  options.form.lobes = 1;
  const FitResult fit = Fit(list, options);
  const std::vector<double> scales = {1e-3, 10, 1e4};
  for (const double& k : scales) {
    if (!IsOneIn(2, {NumberOf(k, scales)})) continue;
    const FitResult scaled = Fit(Times(k, list), options);
    EXPECT_NEAR(scaled.score.relative_objective, fit.score.relative_objective,
                1e-2 * fit.score.relative_objective)
        << k;
    const auto x = fit.model().parameters(), y = scaled.model().parameters();
    for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(y[c], k * x[c], 1e-5 * k) << k;
    const DirectionPair grazing = ToDirections(Degrees(85, 84, 175));
    const double rho = Evaluate(fit.model(), grazing)[0];
    EXPECT_NEAR(Evaluate(scaled.model(), grazing)[0], k * rho, 1e-3 * k * rho) << k;
  }
  // While 1 still means something, the little that gives way is beyond the data.
  EXPECT_LT(Fit(Times(4, list), options).score.relative_objective, 2e-5);
}

// Light beyond the samples is limited by what they show, not by 1 alone.
TEST(LightPromise, BeyondSamplesInOtherUnits) {
  const auto peak_of = [](double k, const Measurement& list) {
    return Peak(FitOf(Times(k, list))) / k;
  };
  const double peak = peak_of(1, MetalToForty());
  for (const double k : {1e-3, 1e3}) EXPECT_NEAR(peak_of(k, MetalToForty()), peak, 0.2 * peak) << k;
  // A highlight alone tells little of the light beside it.
  const double in_units = peak_of(1e3, HighlightAlone());
  EXPECT_LT(in_units, 2);
  EXPECT_NEAR(peak_of(1e-5, HighlightAlone()), in_units, 1e-3 * in_units);
}

TEST(LightPromise, OfATableInOtherUnits) {
  const Measurement table = Source("synth:plastic@24x20x24").Read({});
  const FitResult fit = Fit(table, {.compare = false});
  for (const double k : {1e-20, 1e-3, 4.0, 1e4}) {
    Measurement times = Times(k, table);
    for (std::vector<double>& channel : times.table->stored) {
      for (double& x : channel) x = x < 0 ? x : k * x;
    }
    const FitResult scaled = Fit(times, {.compare = false});
    EXPECT_NEAR(scaled.score.relative_objective, fit.score.relative_objective,
                1e-6 * fit.score.relative_objective)
        << k;
    EXPECT_NEAR(Peak(scaled.model()), k * Peak(fit.model()), 1e-6 * k) << k;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
