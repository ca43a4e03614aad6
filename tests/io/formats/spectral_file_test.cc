#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/model/spectral_materials.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/model_file.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using nlohmann::json;
using testing::ElementsAreArray;
using testing::HasSubstr;

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
    try {
      ParseModel(bad.dump(), "bad.json");
    } catch (const Error& problem) {
      return std::string(problem.what());
    }
    return std::string();
  };
  EXPECT_EQ(error([](json*) {}), "");
  EXPECT_THAT(error([](json* file) { file->erase("wavelengths"); }),
              HasSubstr("bad.json: key 'wavelengths' is missing"));
  EXPECT_THAT(error([](json* file) { (*file)["wavelengths"] = json::array(); }),
              HasSubstr("'wavelengths' must have 1 to 1024 entries, not 0"));
  EXPECT_THAT(error([](json* file) { (*file)["wavelengths"][3] = 560; }),
              HasSubstr("bad.json: the spectral model: no wavelength between 500 and 560 nm"));
  EXPECT_THAT(error([](json* file) { (*file)["wavelengths"][3] = "red"; }),
              HasSubstr("'wavelengths[3]' must be a number"));
  EXPECT_THAT(error([](json* file) { (*file)["wavelengths"].push_back(750); }),
              HasSubstr("'F' must have 8 entries, not 7"));
  EXPECT_THAT(error([](json* file) { (*file)["d"].erase(0); }),
              HasSubstr("'d' must have 7 entries, not 6"));
  EXPECT_THAT(error([](json* file) { (*file)["s"][1][6] = -1; }),
              HasSubstr("'s[1][6]' must be finite and >= 0"));
  EXPECT_THAT(error([](json* file) {
                (*file)["F"][2] = {{"size", 90}, {"nodes", {0}}, {"values", {1}}};
              }),
              HasSubstr("'F[2]' must be an array"));
  EXPECT_THAT(error([](json* file) { (*file)["sharing"]["D"]["per_channel"] = true; }),
              HasSubstr("'D[0]' must have 7 entries"));
  EXPECT_THAT(error([](json* file) {
                (*file)["unobserved"]["F"] = {{0}, {1}};
              }),
              HasSubstr("'unobserved.F' must have 1 entries"));
  EXPECT_THAT(error([](json* file) { (*file)["version"] = 4; }),
              HasSubstr("this program reads versions 1 to 3; update it"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
