// Invalid arguments give an Error of one line, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "io/formats/databases/utia_file.h"
#include "io/pictures/image_file.h"
#include "io/pictures/plots.h"
#include "model/appearance/node_appearance.h"
#include "model/appearance/picture_data.h"
#include "model/measurement/anisotropy.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kCsv = "theta_i,phi_i,theta_o,phi_o,r,g,b\n0,0,30,0,1,1,1\n";

// Whether a source reads them or not.
TEST(Arguments, OptionsOfSources) {
  const auto error = [](const SourceOptions& options) {
    auto of_text = ErrorOf([&] { Source("x.csv", kCsv).Read(options); });
    EXPECT_STREQ(ErrorOf([&] { LoadMeasurement("synth:felt@2x4", options); })->what(),
                 of_text->what());
    Measurement measurement = Source("x.csv", kCsv).Read();
    EXPECT_STREQ(ErrorOf([&] { DecideMeasured(options, &measurement); })->what(), of_text->what());
    return of_text;
  };
  for (const double bad : {kNaN, -1.0}) {
    EXPECT_THAT(error({.noise = bad}), IsError(ErrorKind::kRange, {.key = "noise"}));
    EXPECT_THAT(error({.missing = bad}), IsError(ErrorKind::kRange, {.key = "missing"}));
    EXPECT_THAT(error({.max_angle_deg = bad}), IsError(ErrorKind::kRange, {.key = "max_angle"}));
  }
  for (const double bad : {kNaN, -0.5, 90.0}) {
    EXPECT_THAT(error({.min_theta_d_deg = bad}),
                IsError(ErrorKind::kRange, {.key = "min_theta_d"}));
  }
  EXPECT_THAT(error({.num_threads = -1}),
              IsError(ErrorKind::kRange, {.key = "num_threads", .value = "-1"}));
  EXPECT_THAT(error({.radiometry = "zzz"}),
              IsError(ErrorKind::kUnknown, {.key = "radiometry", .value = "zzz"}));
}

TEST(Arguments, OptionsThatASourceDoesNotReadAreTold) {
  const SourceOptions options = {.noise = 0.1, .extrapolated = true, .radiometry = "srgb"};
  EXPECT_THAT(Source("x.csv", kCsv).Read(options).notes,
              ElementsAre(HasSubstr("--noise"), HasSubstr("--radiom"), HasSubstr("--extrapol")));
  EXPECT_THAT(LoadMeasurement("synth:felt@4x4x4", options).notes,
              ElementsAre(HasSubstr("--extrapolated"), HasSubstr("--radiometry")));
  EXPECT_THAT(Source("x.csv", kCsv).Read().notes, ElementsAre());
}

TEST(Arguments, OfMeasurements) {
  EXPECT_THAT(ErrorOf([] { LimitAngles(1, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the measurement"}));
  EXPECT_THAT(ErrorOf([] { LimitThetaD(1, static_cast<Measurement*>(nullptr)); }),
              IsError(ErrorKind::kMissing, {.key = "the measurement"}));
  EXPECT_THAT(ErrorOf([] { LeaveOutOwnShadow(nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the measurement"}));
  EXPECT_THAT(ErrorOf([] { LeaveOutAtRandom(0, 1, nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "the measurement"}));
  EXPECT_THAT(ErrorOf([] { DecideMeasured({}, static_cast<BrdfTable*>(nullptr)); }),
              IsError(ErrorKind::kMissing, {.key = "the table"}));
  EXPECT_THAT(ErrorOf([] { DecideMeasured({}, static_cast<Measurement*>(nullptr)); }),
              IsError(ErrorKind::kMissing, {.key = "the measurement"}));
  Measurement measurement = Source("x.csv", kCsv).Read();
  for (const double bad : {kNaN, -1.0}) {
    EXPECT_THAT(ErrorOf([&] { LimitAngles(bad, &measurement); }),
                IsError(ErrorKind::kRange, {.key = "max_theta"}));
  }
  EXPECT_THAT(ErrorOf([&] { LimitThetaD(kNaN, &measurement); }),
              IsError(ErrorKind::kRange, {.key = "min_theta_d", .value = "nan"}));
  EXPECT_THAT(ErrorOf([] { SampleCollector("x", "y").LeaveOut(nullptr); }),
              IsError(ErrorKind::kMissing, {.key = "reason"}));
  measurement.samples.directions.clear();
  measurement.anisotropic = true;
  for (const auto& error :
       {ErrorOf([&] { LimitAngles(1, &measurement); }), ErrorOf([&] { AnisotropyOf(measurement); }),
        ErrorOf([&] { ReciprocityError(measurement); }),
        ErrorOf([&] { LeaveOutAtRandom(0.5, 1, &measurement); }),
        ErrorOf([&] { GridOf(measurement); }), ErrorOf([&] { ValuesAtNodes(measurement, {}); })}) {
    EXPECT_THAT(
        error, IsError(ErrorKind::kMismatch, {.file = "x.csv", .key = "directions", .value = "0"}));
  }
}

TEST(Arguments, GridsAndPictures) {
  const FactorModel model(ModelSpec{.lobes = 0});
  const SynthMaterial& felt = FindSynthMaterial("felt");
  for (const HemisphereGrid& bad : {HemisphereGrid{0, 0}, {-1, 4}, {1 << 15, 1 << 15}}) {
    EXPECT_THAT(ErrorOf([&] { ReconstructAtNodes(model, "model", bad); }),
                IsError(ErrorKind::kRange, {.key = "grid of directions"}));
    EXPECT_THAT(ErrorOf([&] { SynthesizeSamples(felt, 0, 1, bad, 1); }),
                IsError(ErrorKind::kRange, {.key = "grid of directions"}));
    EXPECT_THAT(ErrorOf([&] { ParseUtia("", "x.bin", "brdf", bad); }),
                IsError(ErrorKind::kRange, {.key = "grid of directions"}));
    EXPECT_THAT(ErrorOf([&] { AtNodes(Source("x.csv", kCsv).Read(), bad, 1); }),
                IsError(ErrorKind::kRange, {.key = "grid of directions"}));
  }
  EXPECT_THAT(ErrorOf([] { Synthesize(SynthMaterial(), 0, 1, {}, 1); }),
              IsError(ErrorKind::kMissing, {.key = "brdf"}));
  EXPECT_THAT(ErrorOf([] { WritePng("x.png", 2, 2, "short"); }),
              IsError(ErrorKind::kMismatch, {.key = "a picture", .value = "5"}));
  EXPECT_THAT(ErrorOf([] { WritePng("x.png", 0, 0, ""); }),
              IsError(ErrorKind::kRange, {.key = "the width of a picture", .value = "0"}));
}

TEST(Arguments, WhatNoAxisShows) {
  FactorModel model(ModelSpec::SharedFactors(1, {.theta_h = 4, .theta_d = 4}));
  for (double& x : model.parameters()) x = 1e60;  // and their product is beyond all
  EXPECT_THAT(ErrorOf([&] {
                CheckDrawable({model, {}, {}}, {});
              }),
              IsError(ErrorKind::kData, {.key = "model", .value = "the model"}));
  EXPECT_THAT(ErrorOf([&] {
                DrawFactors({model, {}, {}}, "x.png");
              }),
              IsError(ErrorKind::kData, {.key = "model", .value = "the model"}));
  const std::vector<IterationRecord> trace = {{.objective = 1},
                                              {.iteration = 1, .objective = 1e308}};
  EXPECT_THAT(ErrorOf([&] { DrawTrace(trace, "", "x.png"); }),
              IsError(ErrorKind::kData, {.key = "trace", .value = "1"}));
  EXPECT_THAT(ErrorOf([&] { DrawPictures({}, {}, trace, ".", {}); }),
              IsError(ErrorKind::kData, {.key = "trace", .value = "1"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
