#include "model/appearance/sample_table.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/test_util.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Anywhere, of a value that theta_h says.
Measurement Sampled(int samples, bool anisotropic) {
  SampleCollector collector("dense.csv", "test");
  Random random(1);
  for (int j = 0; j < samples; ++j) {
    const SphericalAngles at = {random.Uniform(0, 1.57), 0, random.Uniform(0, 1.57),
                                random.Uniform(0, 2 * kPi)};
    const double rho = 1 + ToHalfDiff(ToDirections(at)).theta_h;
    collector.Add(at, {rho, 2 * rho, 3 * rho});
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = anisotropic;
  return measurement;
}

TEST(TableOfSamples, IsTheMeanInTheBinsOfDenseSamples) {
  const std::optional<BrdfTable> table = TableOfSamples(Sampled(100000, false));
  ASSERT_TRUE(table);
  const TabulatedBrdf brdf(*table);
  for (const double theta_h : {0.2, 0.5, 0.9}) {
    const Rgb rho = brdf.Interpolate(HalfDiffAngles{theta_h, 0.4, 1.5});
    EXPECT_NEAR(rho[0], 1 + theta_h, 0.08);
    EXPECT_NEAR(rho[2], 3 * (1 + theta_h), 0.24);
  }
}

TEST(TableOfSamples, IsNoneOfFewOrOfAnisotropicOnes) {
  EXPECT_FALSE(TableOfSamples(Sampled(1000, false)));
  EXPECT_FALSE(TableOfSamples(Sampled(100000, true)));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
