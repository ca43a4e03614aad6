#include "fit/finish/albedo_ripple.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/axis.h"
#include "trilobe/model/factor_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(AlbedoRipple, IsThatOfAnEntryOfG) {
  FactorModel model(ModelSpec::SharedFactors(1));
  std::ranges::fill(model.parameters(), 1.0);
  std::ranges::fill(model.d(), 0.01);
  const Axis& axis = model.spec().g_axis;
  for (int k = 0; k < axis.size; ++k) {
    model.table(Factor::kD, 0)[k] = 1e3 * std::exp(-0.3 * k);
    model.table(Factor::kG, 0)[k] = std::cos(axis.Theta(k));
  }
  EXPECT_LT(RippleOf(model, 1).share, 0.1 * kSeenRipple);
  constexpr int kEntry = 30;
  model.table(Factor::kG, 0)[kEntry] *= 1.3;
  const AlbedoRipple ripple = RippleOf(model, 1);
  EXPECT_GT(ripple.share, 0.1);
  EXPECT_NEAR(ripple.theta_i, axis.Theta(kEntry), DegreesToRadians(0.5));
  EXPECT_EQ(RippleOf(model, 3).share, ripple.share);
}

// Two lobes that take turns: light from one entry goes to others of the same parity. Samples
// halfway between entries see both.
TEST(AlbedoRipple, IsThatOfTablesThatAlternate) {
  FactorModel model(ModelSpec::SharedFactors(2));
  std::ranges::fill(model.parameters(), 1.0);
  std::ranges::fill(model.d(), 0.01);
  const Axis& axis = model.spec().g_axis;
  for (int lobe = 0; lobe < 2; ++lobe) {
    for (int k = 0; k < axis.size; ++k) {
      model.table(Factor::kD, lobe)[k] = 1e3 * std::exp(-0.3 * k);
      model.table(Factor::kG, lobe)[k] = std::cos(axis.Theta(k)) * (k % 2 == lobe ? 1.2 : 0.1);
    }
  }
  EXPECT_GT(RippleOf(model, 1).share, kSeenRipple);
}

TEST(AlbedoRipple, OfABlackModelIsNone) {
  FactorModel model(ModelSpec::SharedFactors(1));
  std::ranges::fill(model.parameters(), 0.0);
  EXPECT_EQ(RippleOf(model, 1).share, 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
