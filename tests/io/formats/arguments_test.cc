// Invalid arguments give an Error of one line, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "io/formats/merl_file.h"
#include "io/formats/utia_file.h"
#include "io/pictures/image_file.h"
#include "io/pictures/plots.h"
#include "model/appearance/node_appearance.h"
#include "model/appearance/picture_data.h"
#include "model/measurement/anisotropy.h"
#include "tests/test_directory.h"
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
    std::string of_text = ErrorOf([&] { Source("x.csv", kCsv).Read(options); });
    EXPECT_EQ(ErrorOf([&] { LoadMeasurement("synth:felt@2x4", options); }), of_text);
    Measurement measurement = Source("x.csv", kCsv).Read();
    EXPECT_EQ(ErrorOf([&] { DecideMeasured(options, &measurement); }), of_text);
    return of_text;
  };
  for (const double bad : {kNaN, -1.0}) {
    EXPECT_THAT(error({.noise = bad}), HasSubstr("--noise is "));
    EXPECT_THAT(error({.missing = bad}), HasSubstr("--missing is "));
    EXPECT_THAT(error({.max_angle_deg = bad}), HasSubstr("--max_angle is "));
  }
  for (const double bad : {kNaN, -0.5, 90.0}) {
    EXPECT_THAT(error({.min_theta_d_deg = bad}), HasSubstr("--min_theta_d is "));
  }
  EXPECT_THAT(error({.num_threads = -1}), HasSubstr("num_threads"));
  EXPECT_THAT(error({.radiometry = "zzz"}), HasSubstr("known: brdf, cosine, srgb, dj_brdf"));
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
  const auto null = HasSubstr("must not be null");
  EXPECT_THAT(ErrorOf([] { LimitAngles(1, nullptr); }), null);
  EXPECT_THAT(ErrorOf([] { LimitThetaD(1, static_cast<Measurement*>(nullptr)); }), null);
  EXPECT_THAT(ErrorOf([] { LeaveOutOwnShadow(nullptr); }), null);
  EXPECT_THAT(ErrorOf([] { LeaveOutAtRandom(0, 1, nullptr); }), null);
  EXPECT_THAT(ErrorOf([] { DecideMeasured({}, static_cast<BrdfTable*>(nullptr)); }), null);
  EXPECT_THAT(ErrorOf([] { DecideMeasured({}, static_cast<Measurement*>(nullptr)); }), null);
  Measurement measurement = Source("x.csv", kCsv).Read();
  for (const double bad : {kNaN, -1.0}) {
    EXPECT_NE(ErrorOf([&] { LimitAngles(bad, &measurement); }), "");
  }
  EXPECT_NE(ErrorOf([&] { LimitThetaD(kNaN, &measurement); }), "");
  EXPECT_NE(ErrorOf([] { SampleCollector("x", "y").LeaveOut(nullptr); }), "");
  measurement.samples.directions.clear();
  measurement.anisotropic = true;
  for (const auto& error :
       {ErrorOf([&] { LimitAngles(1, &measurement); }), ErrorOf([&] { AnisotropyOf(measurement); }),
        ErrorOf([&] { ReciprocityError(measurement); }),
        ErrorOf([&] { LeaveOutAtRandom(0.5, 1, &measurement); }),
        ErrorOf([&] { GridOf(measurement); }), ErrorOf([&] { ValuesAtNodes(measurement, {}); })}) {
    EXPECT_THAT(error, HasSubstr("x.csv: 1 scattered samples have 0 pairs of directions"));
  }
}

TEST(Arguments, GridsAndPictures) {
  const FactorModel model(ModelSpec{.lobes = 0});
  const SynthMaterial& felt = FindSynthMaterial("felt");
  for (const HemisphereGrid& bad : {HemisphereGrid{0, 0}, {-1, 4}, {1 << 15, 1 << 15}}) {
    EXPECT_THAT(ErrorOf([&] { ReconstructAtNodes(model, "model", bad); }), HasSubstr("theta by"));
    EXPECT_THAT(ErrorOf([&] { SynthesizeSamples(felt, 0, 1, bad, 1); }), HasSubstr("theta by"));
    EXPECT_THAT(ErrorOf([&] { ParseUtia("", "x.bin", "brdf", bad); }), HasSubstr("theta by"));
    EXPECT_THAT(ErrorOf([&] { AtNodes(Source("x.csv", kCsv).Read(), bad, 1); }),
                HasSubstr("theta by"));
  }
  EXPECT_THAT(ErrorOf([] { ParseMerl("", "x.binary", {.theta_h = 0}); }), HasSubstr("grid"));
  EXPECT_NE(ErrorOf([] { Synthesize(SynthMaterial(), 0, 1, {}, 1); }), "");
  EXPECT_NE(ErrorOf([] { WritePng("x.png", 2, 2, "short"); }), "");
  EXPECT_NE(ErrorOf([] { WritePng("x.png", 0, 0, ""); }), "");
}

TEST(Arguments, WhatNoAxisShows) {
  FactorModel model(ModelSpec::SharedFactors(1, {.theta_h = 4, .theta_d = 4}));
  for (double& x : model.parameters()) x = 1e60;  // and their product is beyond all
  EXPECT_THAT(ErrorOf([&] { CheckDrawable({model, {}, {}}, {}); }), HasSubstr("too far to draw"));
  EXPECT_THAT(ErrorOf([&] {
                DrawFactors({model, {}, {}}, "x.png");
              }),
              HasSubstr("too far to draw"));
  const std::vector<IterationRecord> trace = {{.objective = 1},
                                              {.iteration = 1, .objective = 1e308}};
  EXPECT_THAT(ErrorOf([&] { DrawTrace(trace, "", "x.png"); }), HasSubstr("row 1 of the trace"));
  EXPECT_THAT(ErrorOf([&] { DrawPictures({}, {}, trace, ".", {}); }), HasSubstr("of the trace"));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
