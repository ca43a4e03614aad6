#include "fit/finish/retro_rim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/reconstruct.h"
#include "trilobe/model/prepared_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr double kEnd = DegreesToRadians(75), kRise = DegreesToRadians(80);

// A lobe over a diffuse base, whose G rises beyond 80 degrees.
FactorModel Glossy(double rise) {
  FactorModel model(ModelSpec::SharedFactors(1));
  std::ranges::fill(model.d(), 0.02);
  std::ranges::fill(model.s(0), 1.0);
  const ModelSpec& spec = model.spec();
  for (int k = 0; k < spec.d_axis.size; ++k) {
    const double sine = std::sin(spec.d_axis.Theta(k));
    model.table(Factor::kD, 0)[k] = std::exp(-30 * sine * sine) + 0.01;
  }
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    std::ranges::fill(model.table(Factor::kF, t), 0.3);
  }
  for (int k = 0; k < spec.g_axis.size; ++k) {
    const double theta = spec.g_axis.Theta(k);
    model.table(Factor::kG, 0)[k] = std::cos(theta) * (theta > kRise ? rise : 1);
  }
  return model;
}

// Values of a model at scattered directions up to 75 degrees, with those back to the light or not.
Objective DataOf(const FactorModel& model, bool retro) {
  BrdfSamples samples;
  for (int theta_i = 0; theta_i <= 75; theta_i += 5) {
    for (int theta_o = 0; theta_o <= 75; theta_o += 5) {
      for (int phi = 0; phi <= 180; phi += 15) {
        if (!retro && phi < 60) continue;
        samples.directions.push_back(
            {DegreesToRadians(theta_i), 0, DegreesToRadians(theta_o), DegreesToRadians(phi)});
        samples.angles.push_back(ToHalfDiff(ToDirections(samples.directions.back())));
      }
    }
  }
  samples.rho.assign(samples.directions.size(), {});
  samples.rho = EvaluateSamples(model, samples, 1);
  return {samples, model.spec(), FindWeighting("appearance"), 1};
}

double Back(const FactorModel& model, double degrees) {
  const double theta = DegreesToRadians(degrees);
  const Direction w = {std::sin(theta), 0, std::cos(theta)};
  return PreparedModel<double>(model).Value(w, w)[0] * w[2];
}

constexpr auto kAlways = [](const FactorModel&) { return true; };

TEST(RetroRim, IsDimmedToWhatWasMeasured) {
  const FactorModel model = Glossy(40);
  for (const bool retro : {true, false}) {
    const Objective data = DataOf(Glossy(1), retro);
    EXPECT_TRUE(RetroRimOf(data, model).is_seen());
    EXPECT_GT(RetroRimOf(data, model).theta, kEnd);
    const TableLayout layout = TableLayout::Full(model.spec());
    const auto dimmed = WithoutRetroRim(data, model, layout, kAlways, {});
    ASSERT_TRUE(dimmed);
    EXPECT_FALSE(RetroRimOf(data, *dimmed).is_seen());
    EXPECT_LT(Back(*dimmed, 85), 0.5 * Back(model, 85));
    EXPECT_NEAR(Back(*dimmed, 60), Back(model, 60), 1e-9);  // was measured
    EXPECT_FALSE(WithoutRetroRim(data, *dimmed, layout, kAlways, {}));
  }
}

TEST(RetroRim, OfFewStoredNodesIsDimmed) {
  const FactorModel full = Glossy(40);
  const Objective data = DataOf(Glossy(1), true);
  TableLayout layout = TableLayout::Full(full.spec());
  auto& nodes = layout.nodes[static_cast<int>(Factor::kD)][0];
  std::erase_if(nodes, [](int k) { return k % 8 != 0 && k != 89; });
  FactorModel model = full;
  ExpandStored(layout, &model);
  const auto dimmed = WithoutRetroRim(data, model, layout, kAlways, {});
  ASSERT_TRUE(dimmed);
  EXPECT_FALSE(RetroRimOf(data, *dimmed).is_seen());
  FactorModel expanded = *dimmed;
  ExpandStored(layout, &expanded);
  EXPECT_TRUE(std::ranges::equal(expanded.parameters(), dimmed->parameters()));
}

TEST(RetroRim, StaysWhereThereIsNoneOrWhereItIsNotAcceptable) {
  const Objective data = DataOf(Glossy(1), true);
  const TableLayout layout = TableLayout::Full(data.spec());
  EXPECT_FALSE(WithoutRetroRim(data, Glossy(1), layout, kAlways, {}));
  const auto never = [](const FactorModel&) { return false; };
  EXPECT_FALSE(WithoutRetroRim(data, Glossy(40), layout, never, {}));
  EXPECT_FALSE(WithoutRetroRim(data, Glossy(40), layout, kAlways, [] { return true; }));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
