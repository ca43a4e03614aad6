#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/synth.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

BrdfTable Plastic(const MerlGrid& grid) {
  return Synthesize(FindSynthMaterial("plastic"), /*noise=*/0.05, /*seed=*/1, grid,
                    /*num_threads=*/1);
}

// An angle as a file with so many digits behind the point has it.
double Rounded(double radians, double digits) {
  const double unit = std::pow(10, digits);
  return DegreesToRadians(std::round(RadiansToDegrees(radians) * unit) / unit);
}

// Valid bins of a table as scattered samples, every `stride`th of them, with the azimuth of both
// directions turned by `turn` from each to the next.
Measurement Scattered(const BrdfTable& table, double digits, int stride = 1, double turn = 0) {
  SampleCollector collector("x.csv", "CSV file of scattered samples");
  const std::vector<bool> valid = ValidBins(table);
  for (int bin = 0; bin < table.grid.size(); bin += stride) {
    if (!valid[bin]) continue;
    SphericalAngles at = ToSphericalAngles(ToDirections(table.grid.Center(bin)));
    for (double* const phi : {&at.phi_i, &at.phi_o}) *phi += turn * bin;
    for (double* const angle : {&at.theta_i, &at.phi_i, &at.theta_o, &at.phi_o}) {
      *angle = Rounded(*angle, digits);
    }
    collector.Add(at, {table.Value(0, bin), table.Value(1, bin), table.Value(2, bin)});
  }
  return collector.TakeByAzimuths();
}

void ExpectIsTable(const BrdfTable& table, Measurement scattered) {
  TakeMerlBinsAsTable(&scattered);
  ASSERT_TRUE(scattered.table);
  EXPECT_EQ(scattered.table->grid, table.grid);
  EXPECT_EQ(ValidBins(*scattered.table), ValidBins(table));
  EXPECT_FALSE(scattered.anisotropic);
  EXPECT_EQ(scattered.samples.size(), 0);
  ASSERT_EQ(scattered.notes.size(), 1u);
  EXPECT_THAT(scattered.notes[0], HasSubstr("it is a table"));
  const std::vector<bool> valid = ValidBins(table);
  for (int bin = 0; bin < table.grid.size(); ++bin) {
    if (!valid[bin]) continue;
    EXPECT_NEAR(scattered.table->Value(1, bin) / table.Value(1, bin), 1, 1e-14) << bin;
  }
}

TEST(MerlBins, SamplesAtAllCentresAreTheTable) {
  for (const MerlGrid& grid : {MerlGrid{18, 18, 36}, MerlGrid{12, 30, 20}, MerlGrid{40, 15, 11}}) {
    const BrdfTable table = Plastic(grid);
    ExpectIsTable(table, Scattered(table, /*digits=*/12));
  }
}

TEST(MerlBins, AnglesMayBeRounded) {
  const BrdfTable table = Plastic({45, 45, 90});
  ExpectIsTable(table, Scattered(table, /*digits=*/6));
}

// Readers of MERL files give wi an azimuth that turns with phi_d.
TEST(MerlBins, AzimuthsOfBothDirectionsTogetherMayBeAny) {
  const BrdfTable table = Plastic({18, 18, 36});
  ExpectIsTable(table, Scattered(table, /*digits=*/12, /*stride=*/1, /*turn=*/0.1));
}

TEST(MerlBins, AHighlightMayBeMissing) {
  BrdfTable table = Plastic({18, 18, 36});
  for (int bin = 0; bin < table.grid.Index(4, 0, 0); ++bin) table.SetValue(0, bin, -1);
  ExpectIsTable(table, Scattered(table, /*digits=*/12));
}

TEST(MerlBins, AllElseStaysScattered) {
  const BrdfTable table = Plastic({18, 18, 36});
  const auto expect_scattered = [](Measurement measurement) {
    const int samples = measurement.samples.size();
    TakeMerlBinsAsTable(&measurement);
    EXPECT_FALSE(measurement.table);
    EXPECT_EQ(measurement.samples.size(), samples);
    EXPECT_THAT(measurement.notes, IsEmpty());
  };
  expect_scattered(Scattered(table, /*digits=*/12, /*stride=*/7));  // few of the bins
  expect_scattered(Scattered(table, /*digits=*/2));                 // near centres, not at them
  Measurement matters = Scattered(table, /*digits=*/12);
  matters.azimuths_matter = true;
  expect_scattered(matters);
  Measurement repeated = Scattered(table, /*digits=*/12);
  repeated.samples.angles.back() = repeated.samples.angles[0];
  repeated.samples.directions.back() = repeated.samples.directions[0];
  expect_scattered(repeated);
  expect_scattered(SynthesizeSamples(FindSynthMaterial("plastic"), /*noise=*/0, /*seed=*/1,
                                     {.thetas = 9, .phis = 36}, /*num_threads=*/1));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
