#include "trilobe/io/source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/io/tensor_bytes.h"
#include "tests/io/test_directory.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/rgl_file.h"
#include "trilobe/model/measurement_stats.h"

namespace trilobe {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(LoadSource, TellsFilesApartByContent) {
  const TestDirectory directory;
  BrdfTable table = MakeInvalidTable("white", {});
  table.SetValue(1, 5, 0.25);
  WriteMerl(table, directory.Path("a.bsdf"));  // the name says RGL, the content does not
  const BrdfTable merl = LoadSource(directory.Path("a.bsdf"));
  EXPECT_EQ(merl.stored, table.stored);
  EXPECT_EQ(merl.source, directory.Path("a.bsdf"));

  TinyRgl file;
  file.FillConstant(4, 1, 1);
  const std::string path = directory.Make("b.binary", file.Bytes());
  const BrdfTable rgl = LoadSource(path, {.num_threads = 2});
  EXPECT_EQ(rgl.source, path);
  EXPECT_EQ(rgl.grid, MerlGrid());
  EXPECT_EQ(rgl.stored, TabulateRgl(RglBrdf::Parse(file.Bytes(), path), path).stored);
}

TEST(LoadSource, MakesSyntheticMaterials) {
  const BrdfTable table = LoadSource("synth:plastic", {.noise = 0.1, .seed = 3, .num_threads = 2});
  EXPECT_EQ(table.source, "synth:plastic");
  EXPECT_EQ(table.stored,
            LoadSource("synth:plastic", {.noise = 0.1, .seed = 3, .num_threads = 1}).stored);
  EXPECT_NE(table.stored, LoadSource("synth:plastic", {.noise = 0.1, .seed = 4}).stored);
}

TEST(LoadSource, DecidesWhatCountsAsMeasured) {
  const TestDirectory directory;
  TinyRgl file;
  file.theta_i = {0, 1.2F, 1.5707964F};
  file.FillConstant(4, 1, 1);
  file.MaskAll();
  for (int row = 0; row < file.rgb_rows; ++row) file.SetMask(0, row, 3, false);
  const std::string path = directory.Make("masked.bsdf", file.Bytes());
  const BrdfTable whole = LoadSource(path, {.extrapolated = true});
  EXPECT_TRUE(whole.unmeasured.empty());
  EXPECT_EQ(whole.max_theta, kPi / 2);
  const BinCounts all = CountBins(LoadSource(path));
  EXPECT_GT(all.extrapolated, 0);
  EXPECT_GT(all.beyond_nodes, 0);
  // What was left out before keeps its reason.
  const BrdfTable part = LoadSource(path, {.max_angle_deg = 40});
  EXPECT_DOUBLE_EQ(RadiansToDegrees(part.max_theta), 40);
  EXPECT_EQ(CountBins(part).extrapolated, all.extrapolated);
  EXPECT_EQ(CountBins(part).beyond_nodes, all.beyond_nodes);
  EXPECT_GT(CountBins(part).beyond_max_angle, 0);
  EXPECT_EQ(part.stored, whole.stored);
  const BinCounts both = CountBins(LoadSource(path, {.max_angle_deg = 40, .extrapolated = true}));
  EXPECT_EQ(both.extrapolated + both.beyond_nodes, 0);
  EXPECT_EQ(both.beyond_max_angle + both.valid, 1096216);
  // Other sources, too; a limit beyond the last node of an RGL file changes nothing.
  EXPECT_EQ(CountBins(LoadSource("synth:foam", {.max_angle_deg = 40})).valid, both.valid);
  EXPECT_EQ(LoadSource(path, {.max_angle_deg = 80}).unmeasured, LoadSource(path).unmeasured);
  // A MERL file can say no more than that a bin is lost.
  WriteMerl(part, directory.Path("part.binary"));
  const BinCounts merl = CountBins(LoadSource(directory.Path("part.binary")));
  EXPECT_EQ(merl.valid, CountBins(part).valid);
  EXPECT_EQ(merl.negative, 1096216 - merl.valid);
}

TEST(LoadSource, ErrorsSayWhatToDo) {
  const TestDirectory directory;
  EXPECT_THAT(ErrorOf([] { LoadSource("synth:cheese"); }),
              AllOf(HasSubstr("'cheese'"), HasSubstr("known: plastic")));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.Path("missing")); }), HasSubstr("No such file"));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.path()); }), HasSubstr("directory"));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.Make("empty", "")); }), HasSubstr("empty"));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.Make("text", "BRDF of a cheese\n")); }),
              HasSubstr("this is text"));
  WriteModel(ModelFile(), directory.Path("model.json"));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.Path("model.json")); }),
              AllOf(HasSubstr("model.json"), HasSubstr("this is a JSON file; a measurement is a")));
}

}  // namespace
}  // namespace trilobe
