#include "fit/reports/ggx_lobe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "tests/model/materials.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(GgxLobe, OfAGgxModelItsOwnNumbersComeBack) {
  const FactorModel model = AnalyticModel(ModelSpec::SharedFactors(2), 0.15, 0.1);
  const double alpha[] = {0.15, 0.3}, f0[] = {0.1, 0.05};
  for (int m = 0; m < 2; ++m) {
    const auto ggx = NearestGgx(model, m);
    ASSERT_TRUE(ggx);
    EXPECT_NEAR(ggx->alpha_x, alpha[m], 0.01 * alpha[m]);
    EXPECT_EQ(ggx->alpha_x, ggx->alpha_y);
    EXPECT_LT(ggx->elsewhere, 0.01);
    // Schlick's F of the model rises from 0.1 of s.
    for (int c = 0; c < kChannels; ++c) {
      EXPECT_NEAR(ggx->f0[c], f0[m] * (1 - 0.1 * c), 0.04 * f0[m]) << m << " " << c;
    }
  }
}

TEST(GgxLobe, HasTwoRoughnessesWhereFacetsDo) {
  const FactorModel model = AnalyticModel(ModelSpec::AnisotropicFor(1, 48, 1.3), 0.15, 0);
  const auto ggx = NearestGgx(model, 0);
  ASSERT_TRUE(ggx);
  EXPECT_NEAR(std::min(ggx->alpha_x, ggx->alpha_y), 0.15, 0.03);
  EXPECT_NEAR(std::max(ggx->alpha_x, ggx->alpha_y), 0.45, 0.06);
  // Along x is the smaller one, which either may be called.
  const double turn = ggx->alpha_x < ggx->alpha_y ? ggx->turn : ggx->turn + kPi / 2;
  EXPECT_NEAR(std::remainder(turn, kPi), 0, 0.1);
}

TEST(GgxLobe, IsNothingForALobeThatReflectsNothing) {
  FactorModel model = AnalyticModel(ModelSpec::SharedFactors(2), 0.15, 0.1);
  for (double& s : model.s(0)) s = 0;
  std::ranges::fill(model.table(Factor::kD, 1), 0.0);
  EXPECT_FALSE(NearestGgx(model, 0));
  EXPECT_FALSE(NearestGgx(model, 1));
}

TEST(GgxLobe, SaysHowFarOffItIs) {
  FactorModel model = AnalyticModel(ModelSpec::SharedFactors(1), 0.15, 0.1);
  const std::span<double> D = model.table(Factor::kD, 0);
  std::ranges::fill(D.first(D.size() / 2), 0.0);  // no facet lies flat, as in no GGX
  const auto ggx = NearestGgx(model, 0);
  ASSERT_TRUE(ggx);
  EXPECT_GT(ggx->elsewhere, 0.1);
  EXPECT_EQ(GgxText({.alpha_x = 0.25, .alpha_y = 0.25, .f0 = {0.9, 0.6, 0.5}, .elsewhere = 0.031}),
            "alpha 0.25 (roughness 0.5), F0 0.9, 0.6, 0.5; 3.1 % of its facets stand elsewhere");
  EXPECT_EQ(GgxText({.alpha_x = 0.04, .alpha_y = 0.25, .turn = kPi / 2, .f0 = {1, 1, 1}}),
            "alpha 0.04 (roughness 0.2) along 90 deg, 0.25 (roughness 0.5) across, F0 1, 1, 1; 0 % "
            "of its facets stand elsewhere");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
