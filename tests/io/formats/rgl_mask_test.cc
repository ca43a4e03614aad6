// Rules by which bins of an RGL file count as measured (docs/your-data.md).

#include "io/formats/databases/rgl_mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/files/file.h"
#include "io/formats/databases/rgl_file.h"
#include "tests/error_of.h"
#include "tests/io/formats/tensor_bytes.h"
#include "tests/paths.h"
#include "trilobe/model/measurement/measurement_stats.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Nodes of rgb are at sqrt(2 theta_m / pi) = 0, 1/3, 2/3, 1; vndf is constant, so that nothing is
// warped. The last column was not measured.
TinyRgl MaskedRgl() {
  TinyRgl file;
  file.theta_i = {0, 1.2F, 1.5707964F};
  file.FillConstant(4, 1, 1);
  file.MaskAll();
  for (int slice = 0; slice < 2; ++slice) {
    for (int row = 0; row < file.rgb_rows; ++row) file.SetMask(slice, row, 3, false);
  }
  return file;
}

void Flip(TinyRgl* file) { file->valid.flip(); }

RglBrdf Parse(const TinyRgl& file) { return RglBrdf::Parse(file.Bytes(), "tiny.bsdf"); }
std::optional<Error> ParseError(const TinyRgl& file) {
  return ErrorOf([&] { Parse(file); });
}

// Light from theta_i, reflected by facets at theta_m < 90 degrees in the plane of incidence.
bool Measured(const TinyRgl& file, double theta_i, double theta_m) {
  const double theta_o = 2 * theta_m - theta_i;
  return Parse(file)
      .LookUp(
          {{std::sin(theta_i), 0, std::cos(theta_i)}, {std::sin(theta_o), 0, std::cos(theta_o)}})
      .measured;
}

TEST(RglMask, EveryNodeThatIsReadWithWeightMustBeMeasured) {
  const double edge = 4.0 / 9 * kPi / 2;  // theta_m of column 2
  for (const bool flipped : {false, true}) {
    SCOPED_TRACE(flipped);
    TinyRgl file = MaskedRgl();
    if (flipped) Flip(&file);
    for (const double theta_i : {0.1, 0.7, 1.1}) {
      EXPECT_TRUE(Measured(file, theta_i, edge - 0.01));
      EXPECT_FALSE(Measured(file, theta_i, edge + 0.01));
      EXPECT_TRUE(Measured(file, theta_i, 0.3));
    }
    // The slice at 90 degrees counts as measured nowhere, whatever its bits are.
    EXPECT_FALSE(Measured(file, 1.25, 0.3));
  }
}

TEST(RglMask, SlicesWithoutWeightDoNotMatter) {
  TinyRgl file = MaskedRgl();
  for (int row = 0; row < file.rgb_rows; ++row) file.SetMask(1, row, 1, false);
  EXPECT_FALSE(Measured(file, 0.01, 0.1));
  EXPECT_TRUE(Measured(file, 0, 0.1));  // the node of slice 0 itself
}

TEST(RglMask, TheFirstColumnTellsWhatMeansMeasured) {
  // All entries alike: then all are measured, be they 0 or 1.
  for (const bool one : {true, false}) {
    TinyRgl file = MaskedRgl();
    file.valid.assign(file.valid.size(), one);
    for (const double theta_m : {0.1, 0.6, 0.77}) EXPECT_TRUE(Measured(file, 0.2, theta_m));
  }
  // One entry of 40 may be odd, as long as the meaning is clear.
  TinyRgl file = MaskedRgl();
  file.rgb_rows = 20;
  file.FillConstant(4, 1, 1);
  file.MaskAll();
  file.SetMask(1, 7, 0, false);
  EXPECT_TRUE(Measured(file, 0.2, 0.3));
  Flip(&file);
  EXPECT_TRUE(Measured(file, 0.2, 0.3));
  for (int row = 0; row < 20; row += 2) file.SetMask(0, row, 0, true);
  EXPECT_THAT(ParseError(file), IsError(ErrorKind::kFormat, {.key = "valid"}));
}

TEST(RglMask, RefusesAMaskThatDoesNotFit) {
  TinyRgl file = MaskedRgl();
  for (int row = 0; row < file.rgb_rows; ++row) file.SetMask(1, row, 0, false);
  EXPECT_THAT(ParseError(file), IsError(ErrorKind::kFormat, {.file = "tiny.bsdf", .key = "valid"}));
  for (const int size : {28, 44, 8}) {
    file = MaskedRgl();
    file.valid.resize(size);
    EXPECT_THAT(
        ParseError(file),
        IsError(ErrorKind::kMismatch, {.key = "valid", .value = std::to_string((size + 7) / 8)}));
  }
  std::vector<TensorField> fields = MaskedRgl().Fields();
  fields.back().dtype = 2;
  EXPECT_THAT(ErrorOf([&] { RglBrdf::Parse(TensorBytes(fields), "tiny.bsdf"); }),
              IsError(ErrorKind::kFormat, {.key = "valid", .value = "2"}));
  file = MaskedRgl();
  file.theta_i = {1.5707964F};
  file.FillConstant(4, 1, 1);
  file.MaskAll();
  EXPECT_THAT(ParseError(file), IsError(ErrorKind::kData, {.key = "theta_i"}));
}

TEST(RglMask, TheLastNodeBelow90DegreesIsTheLastMeasured) {
  TinyRgl file = MaskedRgl();
  EXPECT_NEAR(Parse(file).max_theta(), 1.2, 1e-7);
  file.theta_i = {0, 1.2F, 1.4F};
  file.MaskAll();
  EXPECT_NEAR(Parse(file).max_theta(), 1.4, 1e-7);
  EXPECT_TRUE(Measured(file, 1.39, 0.3));
  // Without the field all nodes are measured, the last one included.
  file.valid.clear();
  EXPECT_NEAR(Parse(file).max_theta(), 1.4, 1e-7);
  file.theta_i.back() = 1.5707964F;
  EXPECT_EQ(Parse(file).max_theta(), kPi / 2);
  EXPECT_TRUE(Measured(file, 1.5, 0.77));
}

TEST(RglMask, TabulateRglSaysWhyABinIsLeftOut) {
  const TinyRgl file = MaskedRgl();
  const RglBrdf brdf = Parse(file);
  const MerlGrid grid{.theta_h = 20, .theta_d = 20, .phi_d = 20};
  const BrdfTable table = TabulateRgl(brdf, "tiny", grid, 2);
  EXPECT_NEAR(table.max_theta, 1.2, 1e-7);
  ASSERT_EQ(table.unmeasured.size(), static_cast<size_t>(grid.size()));
  const std::vector<bool> above = BinsAboveSurface(grid);
  int extrapolated = 0;
  for (int bin = 0; bin < grid.size(); ++bin) {
    const DirectionPair pair = ToDirections(grid.Center(bin));
    Unmeasured expected = Unmeasured::kNo;
    if (above[bin] && std::min(pair.wi[2], pair.wo[2]) < std::cos(1.2)) {
      expected = Unmeasured::kBeyondNodes;
    } else if (above[bin] && grid.Center(bin).theta_h > 4.0 / 9 * kPi / 2) {
      expected = Unmeasured::kExtrapolated;
      ++extrapolated;
    }
    EXPECT_EQ(table.unmeasured[bin], expected) << bin;
    // The value stays, measured or not.
    if (!above[bin]) continue;
    EXPECT_DOUBLE_EQ(table.Value(0, bin), brdf.Evaluate(pair)[0]);
  }
  const BinCounts counts = CountBins(table);
  EXPECT_GT(counts.extrapolated, 0);
  EXPECT_EQ(counts.extrapolated, extrapolated);
  EXPECT_GT(counts.beyond_nodes, 0);
  EXPECT_EQ(counts.valid + counts.below_surface + counts.extrapolated + counts.beyond_nodes,
            counts.total);
  EXPECT_EQ(TabulateRgl(brdf, "tiny", grid, 1).unmeasured, table.unmeasured);
}

// Real measurements, where they are at hand: each tells its polarity, and most of what is above the
// surface was measured, up to an angle that the gantry reaches.
TEST(RglMask, RealMeasurementsTellWhatWasMeasured) {
  const MerlGrid grid{.theta_h = 30, .theta_d = 30, .phi_d = 60};
  int files = 0;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(MeasuredData("rgl"), error)) {
    if (entry.path().extension() != ".bsdf") continue;
    SCOPED_TRACE(entry.path());
    ++files;
    const BrdfTable table =
        TabulateRgl(RglBrdf::Parse(ReadFile(entry.path()), "file"), "file", grid, 2);
    const BinCounts counts = CountBins(table);
    const double share = static_cast<double>(counts.valid) / (counts.total - counts.below_surface);
    EXPECT_GT(share, 0.65);
    EXPECT_LT(share, 0.9);
    EXPECT_GT(counts.extrapolated, 0);
    EXPECT_GT(RadiansToDegrees(table.max_theta), 75);
    EXPECT_LT(RadiansToDegrees(table.max_theta), 86);
  }
  if (files == 0) GTEST_SKIP() << "no RGL files in " << MeasuredData("rgl");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
