#include "trilobe/model/evaluate/read_terms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/model/spectral/spectral_materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/model_files/terms_file.h"
#include "trilobe/model/terms/term_forms.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

ModelSpec SmallSpec() {
  ModelSpec spec = ModelSpec::SharedFactors(2, {.theta_h = 8, .theta_d = 7, .phi_d = 12});
  spec.stretches = Stretch{.along = 0.5, .across = -0.2};
  return spec;
}

TEST(ReadTerms, ReadsBackWhatWasWritten) {
  for (const TermForm& form : TermForms()) {
    SCOPED_TRACE(form.name);
    TermFile file{.model = form.from(TermModel::Of(RandomModel(SmallSpec(), 3)))};
    file.fit.solver = "terms";
    file.fit.objective = 0.25;
    const TermFile back = ParseTerms(FormatTerms(file), "it");
    EXPECT_EQ(back.model.spec(), file.model.spec());
    EXPECT_TRUE(std::ranges::equal(back.model.parameters(), file.model.parameters()));
    EXPECT_EQ(back.fit.solver, "terms");
    EXPECT_EQ(back.fit.objective, 0.25);
  }
}

TEST(ReadTerms, WavelengthsMakeAColour) {
  const ModelSpec spec = ModelSpec::SharedFactors(2);
  const SpectralModel spectral = AnalyticSpectralModel(spec, VisibleWavelengths(16));
  const TermFile file{.model = TermModel::Of(spectral), .wavelengths = spectral.wavelengths()};
  const TermFile back = ParseTerms(FormatTerms(file), "it");
  EXPECT_EQ(back.wavelengths, spectral.wavelengths());
  const DirectionPair pair = {DirectionAt(0.5, 0), DirectionAt(0.6, 3)};
  const Rgb rgb = RgbOf(back)(ToHalfDiff(pair)), expected = Evaluate(spectral.ToRgb(), pair);
  for (int c = 0; c < kChannels; ++c) EXPECT_NEAR(rgb[c], expected[c], 1e-12);
}

TEST(ReadTerms, WhatIsWrongIsNamed) {
  const std::string text =
      FormatTerms({.model = TermForms()[1].from(TermModel::Of(RandomModel(SmallSpec(), 3)))});
  const auto error_of = [&](const std::string& what, const std::string& by) -> std::string {
    std::string spoilt = text;
    const size_t at = spoilt.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    spoilt.replace(at, what.size(), by);
    try {
      ParseTerms(spoilt, "it.json");
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(error_of("trilobe-terms", "trilobe-model"), HasSubstr("key 'format' must be"));
  EXPECT_THAT(error_of("\"version\": 1", "\"version\": 2"), HasSubstr("update this program"));
  EXPECT_THAT(error_of("\"channels\": 3", "\"channels\": 4"), HasSubstr("it.json: key '"));
  EXPECT_THAT(error_of("\"half\"", "\"whole\""),
              HasSubstr("key 'terms[1].reads[0].at' must be one of \"half\""));
  EXPECT_THAT(error_of("\"root_theta\"", "\"polar\""), HasSubstr("key 'tables[0].axis' must be"));
  EXPECT_THAT(error_of("\"number\": 0", "\"number\": 9"), HasSubstr("it.json: term 'diffuse'"));
  EXPECT_THAT(error_of("\"size\": 8", "\"size\": 9"), HasSubstr("must have 9 entries"));
}

// A changed file is read, or refused by a line that begins with the file's name.
TEST(ReadTerms, SpoiltFilesAreRefused) {
  const std::string text = FormatTerms({.model = TermModel::Of(RandomModel(SmallSpec(), 3))});
  Random random(7);
  for (int k = 0; k < 2000; ++k) {
    std::string spoilt = text;
    const auto below = [&](size_t size) {
      return static_cast<size_t>(random.Uniform() * static_cast<double>(size));
    };
    for (int change = 0; change < 3; ++change) {
      constexpr std::string_view kBytes = "0123456789-+.eE{}[]\",: ntf\\";
      spoilt[below(spoilt.size())] = kBytes[below(kBytes.size())];
    }
    if (k % 5 == 0) spoilt.resize(below(spoilt.size()));
    try {
      ParseTerms(spoilt, "it.json");
    } catch (const Error& error) {
      EXPECT_THAT(std::string(error.what()), testing::StartsWith("it.json"));
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
