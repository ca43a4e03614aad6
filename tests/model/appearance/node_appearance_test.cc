#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "model/appearance/picture_data.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/appearance.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

AppearanceOptions Quick(int num_threads = 1) {
  return {.lights = 80, .size = 24, .num_threads = num_threads};
}

NodeBrdf Steel() { return *PictureDataOf(LoadMeasurement("synth:aniso_ggx_steel@6x24")).nodes; }

NodeBrdf Grey(double rho) {
  NodeTable table{.source = "grey", .grid = {6, 8}, .rho = {}, .present = {}};
  table.rho.assign(static_cast<size_t>(table.grid.nodes()) * table.grid.nodes(), {rho, rho, rho});
  table.present.assign(table.rho.size(), true);
  table.max_theta = 5 * table.grid.ThetaStep();
  return NodeBrdf(table);
}

// The material turned about its normal.
SphericalBrdf Turned(const NodeBrdf& brdf, double phi) {
  return [&brdf, phi](const SphericalAngles& at) {
    return brdf({at.theta_i, at.phi_i + phi, at.theta_o, at.phi_o + phi});
  };
}

TEST(NodeAppearance, OfTheMeasurementItselfIsExact) {
  const NodeBrdf steel = Steel();
  const AppearanceReport report = CompareAppearance(steel, Turned(steel, 0), Quick());
  EXPECT_GT(report.sphere.psnr_db, 300);
  EXPECT_LT(report.sphere.mean_delta_e, 1e-12);
  for (const double x :
       {report.albedo.max, report.at_centers.log, report.between_centers.relative}) {
    EXPECT_EQ(x, 0);
  }
  EXPECT_TRUE(report.at_nodes);
  EXPECT_FALSE(report.beyond);
}

// The sum of cos theta_o over the measured directions of a Lambertian material is rho pi sin^2 75.
TEST(NodeAppearance, AlbedosAreThoseOfMeasuredDirectionsAlongAndAcross) {
  const AppearanceReport report = CompareAppearance(
      Grey(0.1),
      [](const SphericalAngles&) {
        return Rgb{0.1, 0.2, 0.05};
      },
      Quick());
  ASSERT_EQ(report.albedo.theta_i.size(), 12U);
  const double sine = std::sin(DegreesToRadians(75));
  for (int k = 0; k < 12; ++k) {
    EXPECT_NEAR(report.albedo.theta_i[k], DegreesToRadians(15 * (k % 6)), 1e-15);
    EXPECT_EQ(report.albedo.phi_i[k], k < 6 ? 0 : kPi / 2);
    EXPECT_NEAR(report.albedo.measured[k][0], 0.1 * kPi * sine * sine, 4e-3);
    EXPECT_NEAR(report.albedo.fitted[k][1] / report.albedo.measured[k][1], 2, 1e-9);
  }
  EXPECT_NEAR(report.at_centers.relative, (0.1 + 0.05) / 0.101 / 3, 1e-9);
  EXPECT_NEAR(report.between_centers.relative, report.at_centers.relative, 1e-9);
}

TEST(NodeAppearance, SeesATurnAndWhatAMeanLeavesOut) {
  const NodeBrdf steel = Steel();
  const auto psnr = [&](const SphericalBrdf& fitted) {
    return CompareAppearance(steel, fitted, Quick()).sphere.psnr_db;
  };
  const double little = psnr(Turned(steel, 0.05)), quarter = psnr(Turned(steel, kPi / 2));
  EXPECT_GT(little, quarter + 5);
  EXPECT_LT(quarter, 25);
  const double mean = psnr([&](const SphericalAngles& at) {
    Rgb sum{};
    for (int k = 0; k < 24; ++k) {
      const Rgb rho = Turned(steel, 2 * kPi * k / 24)(at);
      for (int c = 0; c < kChannels; ++c) sum[c] += rho[c] / 24;
    }
    return sum;
  });
  EXPECT_GT(mean, quarter);
  EXPECT_LT(mean, little);
}

// Its highlight is narrower than the steps between the nodes.
TEST(NodeAppearance, OfTheFormulaIsExactBetweenTheNodesToo) {
  const PictureData data = PictureDataOf(LoadMeasurement("synth:aniso_ggx_steel@6x24"));
  const SphericalBrdf formula = [&](const SphericalAngles& at) {
    return data.formula(ToDirections(at));
  };
  const AppearanceReport right = CompareAppearance(*data.nodes, formula, Quick(), data.formula);
  EXPECT_LT(right.sphere.mean_delta_e, 1e-6);
  ASSERT_TRUE(right.from_formula.has_value());
  EXPECT_GT(right.from_formula->measured.mean_delta_e, 1);
  // A fit that is a tenth too bright is that on the sphere, too.
  const AppearanceReport tenth = CompareAppearance(
      *data.nodes,
      [&](const SphericalAngles& at) {
        Rgb rho = formula(at);
        for (double& x : rho) x *= 1.1;
        return rho;
      },
      Quick(), data.formula);
  EXPECT_NEAR(tenth.sphere.mean_delta_e, tenth.from_formula->fitted.mean_delta_e, 0.3);
  EXPECT_GT(tenth.sphere.mean_delta_e, 1);
}

// The model may have any values beyond the last theta.
TEST(NodeAppearance, LooksAtMeasuredDirectionsAlone) {
  const NodeBrdf grey = Grey(0.1);
  const AppearanceReport report = CompareAppearance(
      grey,
      [](const SphericalAngles& at) {
        const double rho =
            std::max(at.theta_i, at.theta_o) > DegreesToRadians(75) + 1e-9 ? 1e6 : 0.1;
        return Rgb{rho, rho, rho};
      },
      Quick());
  EXPECT_GT(report.sphere.psnr_db, 200);
  EXPECT_NEAR(report.albedo.max, 0, 1e-12);
}

TEST(NodeAppearance, IsTheSameForAnyNumberOfThreads) {
  const NodeBrdf steel = Steel();
  const SphericalBrdf fitted = Turned(steel, 0.3);
  const AppearanceReport one = CompareAppearance(steel, fitted, Quick(1));
  const AppearanceReport three = CompareAppearance(steel, fitted, Quick(3));
  EXPECT_EQ(one.sphere.psnr_db, three.sphere.psnr_db);
  EXPECT_EQ(one.albedo.mean, three.albedo.mean);
  EXPECT_EQ(one.at_centers.log, three.at_centers.log);
  EXPECT_EQ(one.between_centers.log, three.between_centers.log);
}

TEST(NodeAppearance, OverflowIsAnError) {
  EXPECT_THAT(ErrorOf([] {
                CompareAppearance(
                    Grey(0.1),
                    [](const SphericalAngles&) {
                      return Rgb{1e308, 1e308, 1e308};
                    },
                    Quick());
              }),
              IsError(ErrorKind::kData, {.file = "grey", .key = "model", .value = "overflow"}));
}

TEST(MaterialOf, IsTheModel) {
  Random random(8);
  for (ModelSpec spec : {ModelSpec::Anisotropic(2), ModelSpec::SharedFactors(2)}) {
    FactorModel model(spec);
    for (double& x : model.parameters()) x = random.Uniform();
    const Material material = MaterialOf(model);
    EXPECT_EQ(static_cast<bool>(material.angular), !spec.anisotropic());
    for (int trial = 0; trial < 100; ++trial) {
      const SphericalAngles at = {random.Uniform(0, 1.5), random.Uniform(-4, 4),
                                  random.Uniform(0, 1.5), random.Uniform(-4, 4)};
      const Rgb rho = material.spherical(at), expected = Evaluate(model, ToDirections(at));
      for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(rho[c], expected[c], 1e-6 * expected[c]);
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
