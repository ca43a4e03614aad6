#include "fit/held_out.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "tests/error_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/finish/reach.h"
#include "trilobe/model/objective/weighting.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

ModelSpec Spec() { return ModelSpec::SharedFactors(1, {.theta_h = 8, .theta_d = 6}); }

// Samples of a diffuser, at directions spread as a highlight asks for.
BrdfSamples White(size_t count) {
  BrdfSamples samples;
  samples.source = "white";
  samples.directions = DirectionsBetween(1.3, count, Spread::kByHighlights);
  for (const SphericalAngles& at : samples.directions) {
    samples.angles.push_back(ToHalfDiff(ToDirections(at)));
    samples.rho.push_back({0.2, 0.3, 0.3});
  }
  return samples;
}

Objective Of(BrdfSamples samples) { return {std::move(samples), Spec(), Weightings().front()}; }

int KeptOf(const BrdfSamples& samples, uint64_t seed) {
  return HeldOutPart(samples, seed, 1).RemoveFrom(Of(samples)).samples().size();
}

TEST(HeldOutPart, IsAFifthOfTheSamplesByWholeBlocks) {
  const BrdfSamples samples = White(5000);
  const HeldOutPart part(samples, 1, 1);
  EXPECT_NEAR(part.size(), 1000, 150);
  const BrdfSamples kept = part.RemoveFrom(Of(samples)).samples();
  EXPECT_EQ(kept.size() + part.size(), samples.size());
  // Next to a sample that is kept are only such, and so with those held out: a copy of all samples
  // that is moved by a hundredth of a block is divided alike, but for those at the edges of blocks.
  BrdfSamples moved = samples;
  for (HalfDiffAngles& at : moved.angles) at.theta_d += 0.02 * kPi / 180;
  const BrdfSamples kept_of_moved = HeldOutPart(moved, 1, 1).RemoveFrom(Of(moved)).samples();
  int same = 0;
  for (const SphericalAngles& at : kept.directions) {
    same += static_cast<int>(std::ranges::count_if(kept_of_moved.directions, [&](const auto& it) {
      return it.theta_i == at.theta_i && it.phi_o == at.phi_o && it.theta_o == at.theta_o;
    }));
  }
  EXPECT_GT(same, 0.98 * kept.size());
  EXPECT_LT(same, kept.size());
}

TEST(HeldOutPart, IsAFunctionOfSeedAndAngles) {
  const BrdfSamples samples = White(2000);
  EXPECT_EQ(KeptOf(samples, 3), KeptOf(samples, 3));
  EXPECT_NE(KeptOf(samples, 3), KeptOf(samples, 4));
  BrdfSamples turned = samples;
  std::ranges::reverse(turned.angles);
  std::ranges::reverse(turned.directions);
  EXPECT_EQ(KeptOf(samples, 3), KeptOf(turned, 3));
}

TEST(HeldOutPart, LeavesAPriorAsItIs) {
  const BrdfSamples samples = White(500);
  const Objective data = Of(samples);
  BrdfSamples both = White(700);  // the first 500 are replaced
  for (int j = 0; j < 500; ++j) {
    both.angles[j] = samples.angles[j];
    both.directions[j] = samples.directions[j];
  }
  for (int j = 500; j < 700; ++j) both.rho[j] = {0.7, 0.7, 0.7};
  const HeldOutPart part(samples, 1, 1);
  const Objective left = part.RemoveFrom(Objective(data, both));
  ASSERT_TRUE(left.has_prior());
  EXPECT_EQ(left.data().samples().size(), 500 - part.size());
  EXPECT_EQ(left.samples().size(), 700 - part.size());
  EXPECT_EQ(std::ranges::count(left.samples().rho, (Rgb{0.7, 0.7, 0.7})), 200);
}

TEST(HeldOutPart, ScoresWhatWasNotFitted) {
  BrdfSamples samples = White(2000);
  const HeldOutPart part(samples, 1, 1);
  FactorModel model(Spec());
  std::ranges::fill(model.parameters(), 0.0);
  const auto with_diffuse = [&](double share) {
    std::ranges::copy(Rgb{share * 0.2, share * 0.3, share * 0.3}, model.d().begin());
    return part.Score(model);
  };
  EXPECT_EQ(with_diffuse(1), std::numeric_limits<double>::infinity());
  EXPECT_GT(with_diffuse(0.99), with_diffuse(0.9));
  EXPECT_GT(with_diffuse(0.9), with_diffuse(0.5));
}

TEST(HeldOutPart, RefusesTooFew) {
  EXPECT_THAT(ErrorOf([&] { HeldOutPart(White(1), 1, 1); }),
              IsError(ErrorKind::kData, {.key = "directions", .value = "1"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
