#include "model/measurement/symptoms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

BrdfTable Corrupted(const std::string& corrupt, const std::string& material = "aluminium") {
  SourceOptions options;
  options.corrupt = corrupt;
  return LoadTable("synth:" + material + "@60x30x60", options);
}

std::vector<std::string> Told(const BrdfTable& table) {
  return SymptomsOf(table, /*num_threads=*/2);
}

TEST(Symptoms, CleanDataHaveNone) {
  for (const char* const name : {"plastic", "aluminium", "chrome", "felt", "foam", "rubber"}) {
    EXPECT_THAT(Told(Corrupted("", name)), IsEmpty()) << name;
  }
}

TEST(Symptoms, WhatDoesNotLookLikeOneIsNotTold) {
  for (const char* const corrupt : {"noise:0.01", "gaps:0.9", "zeros:0.05", "outliers:0.05",
                                    "crosstalk:0.1", "beyond:60", "aperture:3"}) {
    EXPECT_THAT(Told(Corrupted(corrupt)), IsEmpty()) << corrupt;
  }
}

TEST(Symptoms, ACosineIsToldAndCanBeTakenOut) {
  for (const int k : {1, -1}) {
    const std::string x = std::to_string(k);
    const CosineSymptom symptom = CosineOf(Corrupted("noise:0.05,cosine:" + x));
    EXPECT_NEAR(symptom.exponent, k, 0.05);
    EXPECT_EQ(symptom.IsOneTooMany(), k == 1);
    EXPECT_EQ(symptom.IsOneTooFew(), k == -1);
    EXPECT_LT(symptom.error_without, 0.1);
    EXPECT_THAT(Told(Corrupted("cosine:" + x)), ElementsAre(HasSubstr("--cosine=" + x)));
    SourceOptions options;
    options.corrupt = "cosine:" + x;
    options.cosine = k;
    EXPECT_THAT(Told(LoadTable("synth:aluminium@60x30x60", options)), IsEmpty());
  }
  EXPECT_FALSE(CosineOf(Corrupted("nonreciprocal:0.3")).IsOneTooMany());
}

TEST(Symptoms, APlateauIsTold) {
  EXPECT_LE(PlateauOf(Corrupted("")).values, 4);
  EXPECT_GT(PlateauOf(Corrupted("clip:0.01")).values, 100);
  EXPECT_THAT(Told(Corrupted("clip:0.01")), ElementsAre(HasSubstr("saturated")));
}

TEST(Symptoms, AConstantRowOrTableIsNoPlateau) {
  for (const char* const source : {"synth:copper@45x45x90", "synth:copper@90x90x180"}) {
    EXPECT_THAT(Told(LoadTable(source)), IsEmpty()) << source;
  }
  BrdfTable constant = LoadTable("synth:copper@20x20x40");
  for (auto& plane : constant.stored) std::ranges::fill(plane, 0.2);
  EXPECT_FALSE(PlateauOf(constant).IsThere());
}

TEST(Symptoms, FewLevelsAreTold) {
  EXPECT_LT(QuantizationOf(Corrupted("")).share, 0.05);
  for (const char* const corrupt : {"quantize:10", "brackets:8"}) {
    EXPECT_THAT(Told(Corrupted(corrupt)), testing::Contains(HasSubstr("few levels"))) << corrupt;
  }
}

TEST(Symptoms, ATiltIsToldByItsAngle) {
  EXPECT_NEAR(TiltOf(Corrupted("")).degrees, 0, 0.05);
  EXPECT_NEAR(TiltOf(Corrupted("tilt:1")).degrees, 1, 0.2);
  // The half vector turns by half of what the detector's arm is off.
  EXPECT_NEAR(TiltOf(Corrupted("origin:4")).degrees, 2, 0.4);
  EXPECT_THAT(Told(Corrupted("tilt:1")), ElementsAre(HasSubstr("is tilted")));
  SourceOptions options;
  options.corrupt = "tilt:1";
  options.tilt_deg = 1;
  EXPECT_NEAR(TiltOf(LoadTable("synth:aluminium@60x30x60", options)).degrees, 0, 0.1);
}

TEST(Symptoms, NoiseIsToldByItsSize) {
  EXPECT_LT(NoiseOf(Corrupted("")).relative, 0.002);
  for (const double noise : {0.01, 0.05, 0.3}) {
    EXPECT_NEAR(NoiseOf(Corrupted("noise:" + std::to_string(noise))).relative, noise, 0.05 * noise);
  }
  EXPECT_THAT(Told(Corrupted("noise:0.05")),
              ElementsAre(HasSubstr("scatter by 5 % about their neighbours")));
}

TEST(Symptoms, RepeatedValuesAreToldByTheirAngle) {
  EXPECT_FALSE(RepetitionOf(Corrupted("")).IsThere());
  for (const int degrees : {60, 72, 80}) {
    const BrdfTable table = Corrupted("repeat:" + std::to_string(degrees));
    EXPECT_NEAR(RepetitionOf(table).degrees, degrees, 4);
    EXPECT_THAT(Told(table), testing::Contains(HasSubstr("repeats the last that was")));
  }
}

TEST(Symptoms, StrayLightIsToldByItsShare) {
  EXPECT_FALSE(StrayLightOf(Corrupted("")).IsThere());
  const BrdfTable table = Corrupted("stray:0.1");
  EXPECT_NEAR(StrayLightOf(table).share, 0.1, 0.05);
  EXPECT_THAT(Told(table), ElementsAre(HasSubstr("as much light from elsewhere")));
}

TEST(Symptoms, AShadowIsTold) {
  EXPECT_THAT(Told(Corrupted("shadow:12")),
              ElementsAre(HasSubstr("a detector stands in its own light; --min_theta_d=")));
}

TEST(Symptoms, BlackAndSmallTablesHaveNone) {
  BrdfTable black = Corrupted("");
  for (auto& plane : black.stored) {
    for (double& x : plane) x = x > 0 ? 0 : x;
  }
  EXPECT_THAT(Told(black), IsEmpty());
  EXPECT_THAT(Told(LoadTable("synth:plastic@4x4x4")), IsEmpty());
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
