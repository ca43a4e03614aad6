#include "model/measurement/unmeasured_samples.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "model/measurement/sample_symptoms.h"
#include "tests/model/measurement/goniometer.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(UnmeasuredSamples, MarksAreLeftOut) {
  int k = 0;
  Measurement marked = Goniometer([&k](SphericalAngles* at, double* rho) {
    if (at->theta_o > 0.5 && ++k % 50 == 0) *rho = 9999;
  });
  const int all = marked.samples.size();
  LeaveOutMarks(&marked);
  EXPECT_LT(marked.samples.size(), all);
  EXPECT_GT(marked.counts.missing, 20);
  EXPECT_THAT(marked.notes, ElementsAre(AllOf(HasSubstr("the value 9999 is there"),
                                              HasSubstr("--outliers takes it"))));
  EXPECT_THAT(SymptomsOfSamples(marked), IsEmpty());
  // A saturated mirror has its highlight alone as often.
  Measurement mirror = Goniometer([](SphericalAngles* at, double* rho) {
    const double theta_h = ToHalfDiff(ToDirections(*at)).theta_h;
    *rho = theta_h < 0.02 ? 400 : 0.05;
  });
  LeaveOutMarks(&mirror);
  EXPECT_EQ(mirror.samples.size(), all);
}

TEST(UnmeasuredSamples, ZerosAmidLightAreGaps) {
  int lost = 0;
  const Measurement shadow = Goniometer([&](SphericalAngles* at, double* rho) {
    if (at->phi_o == 0 && at->theta_o > 0 && std::abs(at->theta_o - at->theta_i) < 0.1) {
      *rho = 0;
      ++lost;
    }
  });
  EXPECT_EQ(FindZeroGaps(shadow.samples).size(), lost);
  for (const int j : FindZeroGaps(shadow.samples)) EXPECT_EQ(shadow.samples.rho[j][0], 0);
  // The end of a highlight of a black material, below the last level of its detector.
  const Measurement dark = Goniometer([&](SphericalAngles*, double* rho) {
    *rho = std::floor(1000 * std::max(*rho - 0.0505, 0.0)) / 1000;
  });
  EXPECT_THAT(FindZeroGaps(dark.samples), IsEmpty());
}

TEST(UnmeasuredSamples, ZerosAboutTheLightAreGapsWhereEachSampleHasItsOwn) {
  int lost = 0, k = 0;
  const auto scattered = [&](double reach_deg) {
    return Goniometer([&, reach_deg](SphericalAngles* at, double* rho) {
      at->theta_i += 1e-4 * ++k;
      const DirectionPair pair = ToDirections(*at);
      if (Dot(pair.wi, pair.wo) < std::cos(DegreesToRadians(reach_deg))) return;
      *rho = 0;
      ++lost;
    });
  };
  const Measurement shadow = scattered(12);
  EXPECT_GT(lost, 20);
  EXPECT_EQ(FindZeroGaps(shadow.samples).size(), lost);
  // These zeros reach too far from the light for the shadow of a detector, and may be what is dark,
  // where other samples are nearly so.
  const Measurement wide = scattered(35);
  BrdfSamples dark = wide.samples;
  for (int j = 0; j < dark.size(); j += 7) dark.rho[j] = {1e-4, 1e-4, 1e-4};
  EXPECT_THAT(FindZeroGaps(dark), IsEmpty());
  EXPECT_GT(FindZeroGaps(wide.samples).size(), 300);
}

TEST(UnmeasuredSamples, AnglesThatRepeatTheOneBeforeWereFilledIn) {
  const Measurement filled = Goniometer([](SphericalAngles* at, double* rho) {
    SphericalAngles seen = *at;
    seen.theta_i = std::min(at->theta_i, DegreesToRadians(60));
    seen.theta_o = std::min(at->theta_o, DegreesToRadians(70));
    *rho = Glossy(seen);
  });
  const FilledSamples found = FindFilled(filled.samples);
  EXPECT_EQ(found.theta_i, 1);
  EXPECT_EQ(found.theta_o, 2);
  EXPECT_EQ(found.samples.size(), 17 * 24 + 5 * 2 * 24);
  EXPECT_THAT(
      FindFilled(Goniometer([](SphericalAngles*, double* rho) { *rho = 0.3; }).samples).samples,
      IsEmpty());
  EXPECT_THAT(FindFilled(Goniometer([](SphericalAngles*, double*) {}).samples).samples, IsEmpty());
  const Measurement matt_outside = Goniometer([](SphericalAngles* at, double* rho) {
    if (at->theta_o > DegreesToRadians(50)) *rho = 0.05;
  });
  EXPECT_THAT(FindFilled(matt_outside.samples).samples, IsEmpty());
  Measurement measurement = filled;
  LeaveOutFill(&measurement);
  EXPECT_EQ(measurement.counts.extrapolated, found.samples.size());
  EXPECT_THAT(measurement.notes, ElementsAre(HasSubstr("--extrapolated takes them")));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
