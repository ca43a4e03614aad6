#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/model/spectral_materials.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/model_file.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using testing::ElementsAreArray;

ModelFile FileOf(const ModelSpec& spec, std::vector<double> wavelengths) {
  ModelFile file;
  file.spectral = AnalyticSpectralModel(spec, std::move(wavelengths));
  file.model = file.spectral->ToRgb();
  file.unobserved.assign(file.model.spec().num_parameters(), false);
  file.fit.source = "red.brdf";
  return file;
}

void ExpectSame(const SpectralModel& a, const SpectralModel& b) {
  EXPECT_EQ(a.spec(), b.spec());
  EXPECT_EQ(a.wavelengths(), b.wavelengths());
  EXPECT_THAT(a.d(), ElementsAreArray(b.d()));
  for (const Factor factor : {Factor::kD, Factor::kG}) {
    for (int t = 0; t < a.spec().num_tables(factor); ++t) {
      EXPECT_THAT(a.table(factor, t), ElementsAreArray(b.table(factor, t)));
    }
  }
  for (int m = 0; m < a.spec().lobes; ++m) {
    EXPECT_THAT(a.s(m), ElementsAreArray(b.s(m)));
    for (int l = 0; l < a.bands(); ++l) EXPECT_THAT(a.F(m, l), ElementsAreArray(b.F(m, l)));
  }
}

TEST(SpectralFile, ReadsBackToTheBit) {
  ModelSpec by_lobe = ModelSpec::SharedFactors(3), one_F = ModelSpec::SharedFactors(2),
            stretched = ModelSpec::SharedFactors(2);
  by_lobe.F.per_lobe = true;
  one_F.F.per_channel = false;
  stretched.stretches = Stretch{.along = 0.5, .across = -0.2};
  for (const ModelSpec& spec : {ModelSpec::SharedFactors(3), by_lobe, one_F, stretched,
                                ModelSpec::Anisotropic(2), ModelSpec::SharedFactors(0)}) {
    for (const std::vector<double>& wavelengths :
         {VisibleWavelengths(7), std::vector<double>{632.8}}) {
      ModelFile file = FileOf(spec, wavelengths);
      for (int m = 0; m < spec.lobes; ++m) {
        for (int c = 0; c < kChannels; ++c) {
          const ModelSpec& rgb = file.model.spec();
          file.unobserved[file.model.TableOffset(Factor::kF, rgb.table(Factor::kF, m, c)) + 5] =
              true;
        }
      }
      const std::string text = FormatModel(file);
      EXPECT_EQ(json::parse(text)["version"], 3);
      const ModelFile again = ParseModel(text, "again");
      ASSERT_TRUE(again.spectral.has_value());
      ExpectSame(*again.spectral, *file.spectral);
      EXPECT_THAT(again.model.parameters(), ElementsAreArray(file.model.parameters()));
      EXPECT_EQ(again.unobserved, file.unobserved);
      EXPECT_EQ(FormatModel(again), text);
    }
  }
}

TEST(SpectralFile, HasTheShapeThatIsDescribed) {
  const json file =
      json::parse(FormatModel(FileOf(ModelSpec::SharedFactors(3), VisibleWavelengths(7))));
  EXPECT_EQ(file["wavelengths"].size(), 7);
  EXPECT_EQ(file["d"].size(), 7);
  EXPECT_EQ(file["s"].size(), 3);
  EXPECT_EQ(file["s"][0].size(), 7);
  EXPECT_EQ(file["D"].size(), 3);
  EXPECT_EQ(file["F"].size(), 7);
  EXPECT_EQ(file["F"][0].size(), 90);
  EXPECT_EQ(file["unobserved"]["F"].size(), 1);
}

TEST(SpectralFile, SaysWhatIsWrong) {
  const json good =
      json::parse(FormatModel(FileOf(ModelSpec::SharedFactors(2), VisibleWavelengths(7))));
  const auto error = [&](const std::function<void(json*)>& spoil) {
    json bad = good;
    spoil(&bad);
    return ErrorOf([&] { ParseModel(bad.dump(), "bad.json"); });
  };
  EXPECT_NO_THROW(ParseModel(good.dump(), "good.json"));
  EXPECT_THAT(error([](json* file) { file->erase("wavelengths"); }),
              IsError(ErrorKind::kMissing, {.file = "bad.json", .key = "wavelengths"}));
  EXPECT_THAT(error([](json* file) { (*file)["wavelengths"] = json::array(); }),
              IsError(ErrorKind::kRange, {.key = "wavelengths"}));
  EXPECT_THAT(
      error([](json* file) { (*file)["wavelengths"][3] = 560; }),
      IsError(ErrorKind::kMissing, {.file = "bad.json", .key = "wavelengths", .value = "560"}));
  EXPECT_THAT(error([](json* file) { (*file)["wavelengths"][3] = "red"; }),
              IsError(ErrorKind::kFormat, {.key = "wavelengths[3]", .value = "string"}));
  EXPECT_THAT(error([](json* file) { (*file)["wavelengths"].push_back(750); }),
              IsError(ErrorKind::kMismatch, {.key = "F", .value = "7"}));
  EXPECT_THAT(error([](json* file) { (*file)["d"].erase(0); }),
              IsError(ErrorKind::kMismatch, {.key = "d", .value = "6"}));
  EXPECT_THAT(error([](json* file) { (*file)["s"][1][6] = -1; }),
              IsError(ErrorKind::kRange, {.key = "s[1][6]", .value = "-1"}));
  EXPECT_THAT(error([](json* file) {
                (*file)["F"][2] = {{"size", 90}, {"nodes", {0}}, {"values", {1}}};
              }),
              IsError(ErrorKind::kFormat, {.key = "F[2]", .value = "object"}));
  EXPECT_THAT(error([](json* file) { (*file)["sharing"]["D"]["per_channel"] = true; }),
              IsError(ErrorKind::kMismatch, {.key = "D[0]", .value = "90"}));
  EXPECT_THAT(error([](json* file) {
                (*file)["unobserved"]["F"] = {{0}, {1}};
              }),
              IsError(ErrorKind::kMismatch, {.key = "unobserved.F", .value = "2"}));
  EXPECT_THAT(error([](json* file) { (*file)["version"] = 4; }),
              IsError(ErrorKind::kUnsupported, {.key = "version", .value = "4"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
