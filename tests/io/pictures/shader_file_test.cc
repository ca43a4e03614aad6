#include "io/pictures/shader_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "io/pictures/document.h"
#include "tests/error_of.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {
namespace {

using testing::HasSubstr;
using testing::Not;

FactorModel Ones(const ModelSpec& spec) {
  FactorModel model(spec);
  std::ranges::fill(model.parameters(), 0.5);
  return model;
}

TEST(Base64, IsThatOfRfc4648) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64("\xff\xfe"), "//4=");
  EXPECT_EQ(Base64("foobar", 4), "Zm9v\nYmFy");
}

TEST(ShaderTables, HoldEntriesFourTablesInATexel) {
  FactorModel model = Ones(ModelSpec::SharedFactors(3));
  for (int e = 0; e < 90; ++e) model.table(Factor::kD, 1)[e] = 2 + e;
  const ShaderTables tables = MakeShaderTables(model, /*sampled=*/false);
  EXPECT_THAT(tables.preamble, HasSubstr("#define TB_LOBES 3\n"));
  EXPECT_THAT(tables.preamble, HasSubstr("#define TB_D_GROUPS 1\n"));
  EXPECT_THAT(tables.preamble, HasSubstr("#define TB_D_BASE 0\n"));
  EXPECT_THAT(tables.preamble, Not(HasSubstr("TB_ROWS")));
  EXPECT_EQ(tables.texels[4 * 7 + 0], 0.5F);
  EXPECT_EQ(tables.texels[4 * 7 + 1], 9.0F);
  EXPECT_EQ(tables.texels[4 * 7 + 3], 0.0F);
  EXPECT_EQ(tables.texels.size() % (4 * kShaderWidth), 0U);
}

TEST(ShaderTables, TakeModelsWithoutLobes) {
  const ShaderTables tables = MakeShaderTables(Ones(ModelSpec{.lobes = 0}), /*sampled=*/true);
  EXPECT_THAT(tables.preamble, HasSubstr("#define TB_LOBES 0\n"));
  EXPECT_GE(tables.rows(), 1);
}

TEST(ShaderTables, RefuseWhatFloatsCannotHold) {
  FactorModel model = Ones(ModelSpec::SharedFactors(1));
  model.table(Factor::kF, 0)[3] = 1e60;
  EXPECT_THAT(ErrorOf([&] { MakeShaderTables(model, /*sampled=*/false); }),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
  model.table(Factor::kF, 0)[3] = -1;
  EXPECT_THAT(ErrorOf([&] { MakeShaderTables(model, /*sampled=*/false); }),
              IsError(ErrorKind::kData, {.key = "parameter 99", .value = "-1"}));
}

TEST(ShaderFile, HasItsNameOnlyInAComment) {
  const ShaderFile file = FormatShader(ModelFile{Ones(ModelSpec::SharedFactors(1)), {}, {}, {}},
                                       "a*/b\nvoid x() {}", ShaderLanguage::kGlsl);
  EXPECT_THAT(file.text, HasSubstr("vec3 trilobe_eval(vec3 wi, vec3 wo)"));
  EXPECT_THAT(file.text, HasSubstr("vec3 trilobe_sample(vec3 wi, vec2 u, out float pdf"));
  EXPECT_THAT(file.text.substr(0, file.text.find('\n')), HasSubstr("void x"));
}

TEST(ShaderFile, IsHlslByOtherWords) {
  const ShaderFile file = FormatShader(ModelFile{Ones(ModelSpec::SharedFactors(2)), {}, {}, {}},
                                       "model.json", ShaderLanguage::kHlsl);
  EXPECT_THAT(file.text, HasSubstr("float3 trilobe_eval(float3 wi, float3 wo)"));
  EXPECT_THAT(file.text, HasSubstr("trilobe_specular[2] = {float3(0.5"));
  EXPECT_THAT(file.text, HasSubstr("trilobe_tables.Load(int3("));
  for (const char* const word : {"vec2", "vec3", "vec4", "mix(", "texelFetch", "uniform"}) {
    EXPECT_THAT(file.text, Not(HasSubstr(word)));
  }
}

}  // namespace
}  // namespace trilobe
