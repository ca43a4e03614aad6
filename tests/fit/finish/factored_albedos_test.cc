#include "fit/finish/factored_albedos.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "fit/finish/albedos_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/measurement/albedo.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// A model whose entries all differ.
FactorModel Uneven(const ModelSpec& spec) {
  FactorModel model(spec);
  double k = 0;
  for (double& x : model.parameters()) x = 1 + 0.5 * std::sin(k += 0.7);
  return model;
}

std::vector<double> Angles() {
  std::vector<double> theta_i;
  for (const double degrees : {0.0, 31.0, 64.5, 80.0, 89.5}) {
    theta_i.push_back(DegreesToRadians(degrees));
  }
  return theta_i;
}

ModelSpec Spec(bool d_per_channel) {
  ModelSpec spec = ModelSpec::SharedFactors(2);
  spec.D.per_channel = d_per_channel;
  if (d_per_channel) spec.stretches = Stretches({{0.1, 0.4}, {0, 0.2}});
  spec.d_axis.size = 20;
  spec.f_axis.size = 12;
  spec.g_axis.size = 9;
  return spec;
}

TEST(FactoredAlbedos, AreThoseOfModelsWithTheSameD) {
  for (const bool d_per_channel : {false, true}) {
    const ModelSpec spec = Spec(d_per_channel);
    FactorModel model = Uneven(spec);
    const FactoredAlbedos albedos(model, Angles(), 2);
    for (const Factor factor : {Factor::kF, Factor::kG}) {
      for (int t = 0; t < spec.num_tables(factor); ++t) {
        for (double& x : model.table(factor, t)) x *= x;
      }
    }
    model.d()[1] = 3;
    model.s(1)[2] = 0.2;
    const std::vector<Rgb> expected = AlbedosOf(model, Angles(), 2), found = albedos(model);
    ASSERT_EQ(found.size(), expected.size());
    for (size_t k = 0; k < expected.size(); ++k) {
      for (int c = 0; c < kChannels; ++c) {
        EXPECT_NEAR(found[k][c], expected[k][c], 1e-6 * expected[k][c]) << k;
      }
    }
    EXPECT_EQ(albedos(model, 3).front(), found[3]);
    EXPECT_EQ(FactoredAlbedos(model, Angles(), 1)(model),
              FactoredAlbedos(model, Angles(), 3)(model));
  }
}

// One side of the plane of incidence tells of the other.
TEST(AlbedosOf, AreDirectionalAlbedos) {
  const FactorModel model = Uneven(Spec(false));
  const std::vector<Rgb> found = AlbedosOf(model, Angles(), 2);
  for (size_t k = 0; k < found.size(); ++k) {
    const Rgb expected = DirectionalAlbedo(
        [&](const DirectionPair& pair) { return Evaluate(model, pair); }, Angles()[k]);
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(found[k][c], expected[c], 1e-9 * expected[c]) << k;
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
