#include "trilobe/io/source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/io/tensor_bytes.h"
#include "tests/io/test_directory.h"
#include "trilobe/io/merl_file.h"
#include "trilobe/io/model_file.h"
#include "trilobe/io/rgl_file.h"

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

TEST(LoadSource, ErrorsSayWhatToDo) {
  const TestDirectory directory;
  EXPECT_THAT(ErrorOf([] { LoadSource("synth:cheese"); }),
              AllOf(HasSubstr("'cheese'"), HasSubstr("known: plastic")));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.Path("missing")); }), HasSubstr("No such file"));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.path()); }), HasSubstr("directory"));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.Make("empty", "")); }), HasSubstr("empty"));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.Make("text", "BRDF of a cheese\n")); }),
              HasSubstr("looks like text"));
  WriteModel(ModelFile(), directory.Path("model.json"));
  EXPECT_THAT(ErrorOf([&] { LoadSource(directory.Path("model.json")); }),
              AllOf(HasSubstr("model.json"), HasSubstr("not a measurement")));
}

}  // namespace
}  // namespace trilobe
