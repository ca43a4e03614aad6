#include "model/measurement/own_shadow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <string>

#include "tests/error_of.h"
#include "tests/test_directory.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
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
    EXPECT_LE(shadow.darker, 25);  // held against the same light or a little further out
    EXPECT_GT(shadow.darker, 18);
  }
  EXPECT_EQ(FindOwnShadow(Highlight(20, 1e9)).theta_d_deg, 20);
  EXPECT_EQ(FindOwnShadow(Highlight(20, 1e9)).darker, 1000);
}

TEST(OwnShadow, IsNotWhatMaterialsDo) {
  EXPECT_EQ(FindOwnShadow(Highlight(0, 1)).theta_d_deg, 0);
  EXPECT_EQ(FindOwnShadow(Highlight(12, 3.5)).theta_d_deg, 0);  // not dark enough
  EXPECT_EQ(FindOwnShadow(Highlight(3, 25)).theta_d_deg, 5);    // the largest that is looked for
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

// At most `most` of the samples for which `is_limited` holds, and all others.
BrdfSamples WithFew(const BrdfSamples& samples, int most,
                    const std::function<bool(double theta_d_deg)>& is_limited) {
  BrdfSamples few;
  int limited = 0;
  for (int j = 0; j < samples.size(); ++j) {
    const HalfDiffAngles& at = samples.angles[j];
    const bool counts = at.theta_h < DegreesToRadians(0.5);  // one class of the highlight
    if (!counts || (is_limited(RadiansToDegrees(at.theta_d)) && ++limited > most)) continue;
    few.angles.push_back(at);
    few.rho.push_back(samples.rho[j]);
  }
  return few;
}

TEST(OwnShadow, NeedsSamplesInItsMiddleAndInTheLight) {
  const BrdfSamples samples = Highlight(12, 25);
  constexpr double kEnd = 13;  // since a class has six samples a degree, and ten tell of the end
  const auto middle = [](double theta_d) { return theta_d < 5; };
  const auto lit = [](double theta_d) { return theta_d > 20; };
  EXPECT_EQ(FindOwnShadow(WithFew(samples, 9, middle)).theta_d_deg, 0);
  EXPECT_EQ(FindOwnShadow(WithFew(samples, 10, middle)).theta_d_deg, kEnd);
  EXPECT_EQ(FindOwnShadow(WithFew(samples, 2, lit)).theta_d_deg, 0);
  EXPECT_EQ(FindOwnShadow(WithFew(samples, 3, lit)).theta_d_deg, kEnd);
}

TEST(OwnShadow, EndsWhereFourOfFiveAreBright) {
  for (const int dark_of_eight : {1, 2}) {
    BrdfSamples samples = Highlight(12, 25);
    for (int j = 0; j < samples.size(); ++j) {
      const double theta_d = RadiansToDegrees(samples.angles[j].theta_d);
      if (theta_d > 14 && theta_d < 15 && j % 8 < dark_of_eight) samples.rho[j] = {};
    }
    EXPECT_EQ(FindOwnShadow(samples).theta_d_deg, dark_of_eight == 1 ? 12 : 15);
  }
  // One dark sample alone in its degrees ends nothing.
  BrdfSamples samples =
      WithFew(Highlight(12, 25), 1, [](double theta_d) { return theta_d > 17 && theta_d < 20; });
  for (int j = 0; j < samples.size(); ++j) {
    const double theta_d = RadiansToDegrees(samples.angles[j].theta_d);
    if (theta_d > 17 && theta_d < 20) samples.rho[j] = {};
  }
  EXPECT_EQ(FindOwnShadow(samples).theta_d_deg, 13);
}

TEST(OwnShadow, KnowsWholeDegrees) {
  for (int last = 6; last < 18; ++last) {
    BrdfSamples samples;
    for (int theta = 1; theta <= 40; ++theta) {
      for (int phi = 0; phi < 360; phi += 30) {
        const double angle = DegreesToRadians(theta), azimuth = DegreesToRadians(phi);
        const Rgb rho = theta <= last ? Rgb{0.01, 0.01, 0.01} : Rgb{1, 1, 1};
        const SphericalAngles at = {angle, azimuth, angle, azimuth + kPi};
        samples.angles.push_back(ToHalfDiff(ToDirections(at)));
        samples.directions.push_back(at);
        samples.rho.push_back(rho);
      }
    }
    EXPECT_EQ(FindOwnShadow(samples).theta_d_deg, last + 1);
  }
}

// A highlight that is narrower than the steps of theta_h, or than those of the grid it was measured
// on, where the samples next to theta_d = 0 are further from its middle than others.
TEST(OwnShadow, IsNotANarrowHighlight) {
  const auto gaussian = [](double theta_h, double sigma_deg) {
    const double x = RadiansToDegrees(theta_h) / sigma_deg;
    const double rho = std::exp(-x * x / 2);
    return Rgb{rho, rho, rho};
  };
  BrdfSamples samples = Highlight(0, 1);
  for (int j = 0; j < samples.size(); ++j) {
    HalfDiffAngles& at = samples.angles[j];
    const bool is_at_the_top = at.theta_h < DegreesToRadians(0.2);
    if (at.theta_d < DegreesToRadians(12) && is_at_the_top) at.theta_h *= 3;
    samples.rho[j] = gaussian(at.theta_h, 0.15);
  }
  EXPECT_EQ(FindOwnShadow(samples).theta_d_deg, 0);

  for (const double sigma_deg : {0.15, 0.25, 0.5}) {
    BrdfSamples grid;
    for (int theta_i = 0; theta_i <= 75; theta_i += 5) {
      for (double theta_o = 0; theta_o <= 75; theta_o += 1.5) {
        for (int phi_o = 0; phi_o < 360; phi_o += 30) {
          const SphericalAngles at = {DegreesToRadians(theta_i), 0, DegreesToRadians(theta_o),
                                      DegreesToRadians(phi_o)};
          grid.angles.push_back(ToHalfDiff(ToDirections(at)));
          grid.directions.push_back(at);
          grid.rho.push_back(gaussian(grid.angles.back().theta_h, sigma_deg));
        }
      }
    }
    EXPECT_EQ(FindOwnShadow(grid).theta_d_deg, 0) << sigma_deg;
  }
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
              ElementsAre(testing::AllOf(HasSubstr("20 times darker"),
                                         HasSubstr(std::to_string(in_shadow) + " samples below 8"),
                                         HasSubstr("--min_theta_d=0"))));

  // The shadow is also found within a limit that leaves no light to compare with.
  const Measurement near = LoadMeasurement(path, {.max_angle_deg = 20});
  EXPECT_EQ(near.counts.below_min_theta_d, in_shadow);
  EXPECT_THAT(near.notes, testing::SizeIs(1));

  const Measurement told = LoadMeasurement(path, {.min_theta_d_deg = 10.5});
  EXPECT_EQ(told.counts.below_min_theta_d, samples.size() / 4);  // 10 centres of 40
  EXPECT_THAT(told.notes, IsEmpty());
  EXPECT_THAT(ErrorOf([&] { SamplesOf(LoadMeasurement(path, {.min_theta_d_deg = 80})); }),
              IsError(ErrorKind::kData, {.file = path, .key = "samples", .value = "0"}));
}

TEST(LimitThetaD, MarksBinsOfATable) {
  const BrdfTable whole = LoadTable("synth:foam");
  const BrdfTable part = LoadTable("synth:foam", {.max_angle_deg = 60, .min_theta_d_deg = 10});
  const BrdfTable limited = LoadTable("synth:foam", {.max_angle_deg = 60});
  const std::vector<bool> valid = ValidBins(part), before = ValidBins(limited);
  for (int bin = 0; bin < whole.grid.size(); ++bin) {
    const bool lit = whole.grid.Center(bin).theta_d >= DegreesToRadians(10);
    ASSERT_EQ(valid[bin], before[bin] && lit) << bin;
  }
  EXPECT_GT(CountBins(part).below_min_theta_d, 0);
  EXPECT_EQ(CountBins(part).beyond_max_angle, CountBins(limited).beyond_max_angle);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
