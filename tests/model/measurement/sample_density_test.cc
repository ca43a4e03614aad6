#include "model/measurement/sample_density.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/test_util.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// One in the middle of each cell of 7.5 by 7.5 by 15 degrees up to 75 degrees, and `more` beside
// the one at theta_i = theta_o = 33.75 that is opposite.
Measurement Cells(int more) {
  SampleCollector collector("cells", "test");
  const auto add = [&](double theta_i, double theta_o, double phi) {
    collector.Add({DegreesToRadians(theta_i), 0, DegreesToRadians(theta_o), DegreesToRadians(phi)},
                  {0.1, 0.1, 0.1});
  };
  for (int i = 0; i < 10; ++i) {
    for (int o = 0; o <= i; ++o) {
      for (int phi = 0; phi < 12; ++phi) add(7.5 * i + 3.75, 7.5 * o + 3.75, 15 * phi + 7.5);
    }
  }
  for (int k = 0; k < more; ++k) add(33.75, 33.75 + 1e-3 * (k + 1), 172.5);
  return collector.Take();
}

TEST(SampleDensity, EvenSamplesStayAsTheyAre) {
  EXPECT_THAT(SamplesOf(Cells(0)).multiplicity, testing::IsEmpty());
  EXPECT_THAT(SamplesOf(Cells(3)).multiplicity, testing::IsEmpty());
  EXPECT_THAT(SamplesOf(LoadMeasurement("synth:felt@10x10x20")).multiplicity, testing::IsEmpty());
}

TEST(SampleDensity, ADenseCellCountsAsFourTimesTheMedian) {
  constexpr int kMore = 99;
  const BrdfSamples samples = SamplesOf(Cells(kMore));
  const auto& counts = samples.multiplicity;
  ASSERT_EQ(counts.size(), samples.rho.size());
  EXPECT_NEAR(std::accumulate(counts.begin(), counts.end(), 0.0), samples.size() - kMore + 3, 1e-9);
  EXPECT_EQ(std::ranges::count(counts, 1.0), samples.size() - kMore - 1);
  EXPECT_EQ(std::ranges::count(counts, 4.0 / (kMore + 1)), kMore + 1);
  BrdfSamples again = samples;
  EvenOutDensity(&again);
  EXPECT_EQ(again.multiplicity, counts);
  // Samples in the other order of light and eye lie in the same cells.
  Measurement exchanged = Cells(kMore);
  for (SphericalAngles& at : exchanged.samples.directions) {
    at = {at.theta_o, at.phi_o, at.theta_i, at.phi_i};
  }
  EXPECT_EQ(SamplesOf(exchanged).multiplicity, counts);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
