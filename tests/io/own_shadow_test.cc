#include "trilobe/io/own_shadow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "tests/io/test_directory.h"
#include "trilobe/brdf/directions.h"
#include "trilobe/io/source.h"

namespace trilobe {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A highlight of theta_h, three pairs of directions in each degree of theta_d and quarter of one of
// theta_h; it is `darker` times darker below `end_deg`.
BrdfSamples Highlight(double end_deg, double darker) {
  BrdfSamples samples;
  for (double theta_d = 0.5; theta_d < 40; ++theta_d) {
    for (double theta_h = 0.125; theta_h < 6; theta_h += 0.25) {
      for (const double phi_d : {20.0, 70.0, 110.0}) {
        const HalfDiffAngles at = {.theta_h = DegreesToRadians(theta_h),
                                   .theta_d = DegreesToRadians(theta_d),
                                   .phi_d = DegreesToRadians(phi_d)};
        const double rho = 3 / (1 + theta_h * theta_h) * (theta_d < end_deg ? 1 / darker : 1);
        samples.angles.push_back(at);
        samples.directions.push_back(ToSphericalAngles(ToDirections(at)));
        samples.rho.push_back({rho, rho, rho / 2});
      }
    }
  }
  return samples;
}

TEST(OwnShadow, EndsWhereTheHighlightComesBack) {
  for (const double end : {6.0, 12.0, 17.0}) {
    const OwnShadow shadow = FindOwnShadow(Highlight(end, /*darker=*/25));
    EXPECT_EQ(shadow.theta_d_deg, end);
    EXPECT_NEAR(shadow.darker, 25, 1e-9);
  }
  EXPECT_EQ(FindOwnShadow(Highlight(20, 1e9)).theta_d_deg, 20);
  EXPECT_EQ(FindOwnShadow(Highlight(20, 1e9)).darker, 1000);
}

TEST(OwnShadow, IsNotWhatMaterialsDo) {
  EXPECT_EQ(FindOwnShadow(Highlight(0, 1)).theta_d_deg, 0);
  EXPECT_EQ(FindOwnShadow(Highlight(12, 3.5)).theta_d_deg, 0);  // not dark enough
  EXPECT_EQ(FindOwnShadow(Highlight(3, 25)).theta_d_deg, 5);    // as far as one is looked for
  EXPECT_EQ(FindOwnShadow(Highlight(2, 25)).theta_d_deg, 0);    // not the half of it
  EXPECT_EQ(FindOwnShadow({}).theta_d_deg, 0);
  BrdfSamples few = Highlight(12, 25);
  for (auto& rho : few.rho) rho = {};
  EXPECT_EQ(FindOwnShadow(few).theta_d_deg, 0);  // nothing is lit
  for (const std::string name : {"copper", "chrome", "charmeuse", "velvet", "rolled_brass"}) {
    const BrdfFunction formula = LoadMeasurement("synth:" + name + "@2x3").formula;
    BrdfSamples samples = Highlight(0, 1);
    for (int j = 0; j < samples.size(); ++j) {
      samples.rho[j] = formula(ToDirections(samples.directions[j]));
    }
    EXPECT_EQ(FindOwnShadow(samples).theta_d_deg, 0) << name;
  }
}

TEST(OwnShadow, NeedsSamplesInItsMiddle) {
  BrdfSamples samples = Highlight(12, 25), few;
  int middle = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const HalfDiffAngles& at = samples.angles[j];
    const bool in_middle = at.theta_d < DegreesToRadians(5) && at.theta_h < DegreesToRadians(2);
    if (in_middle && ++middle > 9) continue;
    few.angles.push_back(at);
    few.rho.push_back(samples.rho[j]);
  }
  EXPECT_EQ(FindOwnShadow(few).theta_d_deg, 0);
}

TEST(OwnShadow, IsLeftOutAndTold) {
  const TestDirectory directory;
  const std::string path = directory.Path("x.csv");
  const BrdfSamples samples = Highlight(8, 25);
  {
    std::ofstream file(path);
    file.precision(17);
    file << "theta_i,phi_i,theta_o,phi_o,r,g,b\n";
    for (int j = 0; j < samples.size(); ++j) {
      const SphericalAngles& at = samples.directions[j];
      for (const double angle : {at.theta_i, at.phi_i, at.theta_o, at.phi_o}) {
        file << RadiansToDegrees(angle) << ",";
      }
      const auto& [r, g, b] = samples.rho[j];
      file << r << "," << g << "," << b << "\n";
    }
  }
  const Measurement whole = LoadMeasurement(path, {.min_theta_d_deg = 0});
  EXPECT_EQ(whole.counts.valid, samples.size());
  EXPECT_THAT(whole.notes, IsEmpty());

  const Measurement lit = LoadMeasurement(path);
  const int in_shadow = samples.size() / 5;  // 8 of 40 degrees
  EXPECT_EQ(lit.counts.below_min_theta_d, in_shadow);
  EXPECT_EQ(lit.counts.valid, samples.size() - in_shadow);
  EXPECT_EQ(lit.samples.size(), lit.counts.valid);
  EXPECT_THAT(lit.notes,
              ElementsAre(testing::AllOf(HasSubstr("25 times darker"),
                                         HasSubstr(std::to_string(in_shadow) + " samples below 8"),
                                         HasSubstr("--min_theta_d=0"))));

  const Measurement told = LoadMeasurement(path, {.min_theta_d_deg = 10.5});
  EXPECT_EQ(told.counts.below_min_theta_d, samples.size() / 4);  // 10 centres of 40
  EXPECT_THAT(told.notes, IsEmpty());
  EXPECT_THAT(ErrorOf([&] { SamplesOf(LoadMeasurement(path, {.min_theta_d_deg = 80})); }),
              HasSubstr("--min_theta_d"));
}

TEST(LimitThetaD, MarksBinsOfATable) {
  const BrdfTable whole = LoadSource("synth:foam");
  const BrdfTable part = LoadSource("synth:foam", {.max_angle_deg = 60, .min_theta_d_deg = 10});
  const BrdfTable limited = LoadSource("synth:foam", {.max_angle_deg = 60});
  const std::vector<bool> valid = ValidBins(part), before = ValidBins(limited);
  for (int bin = 0; bin < whole.grid.size(); ++bin) {
    const bool lit = whole.grid.Center(bin).theta_d >= DegreesToRadians(10);
    ASSERT_EQ(valid[bin], before[bin] && lit) << bin;
  }
  EXPECT_GT(CountBins(part).below_min_theta_d, 0);
  EXPECT_EQ(CountBins(part).beyond_max_angle, CountBins(limited).beyond_max_angle);
}

}  // namespace
}  // namespace trilobe
