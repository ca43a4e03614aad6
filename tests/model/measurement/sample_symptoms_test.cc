#include "model/measurement/sample_symptoms.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "io/formats/source_option.h"
#include "model/measurement/unmeasured_samples.h"
#include "tests/error_of.h"
#include "tests/model/measurement/goniometer.h"
#include "tests/paths.h"
#include "tests/test_directory.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <typename Change>
std::vector<std::string> Told(const Change& change) {
  return SymptomsOfSamples(Goniometer(change));
}

TEST(SampleSymptoms, CleanSamplesHaveNone) {
  EXPECT_THAT(Told([](SphericalAngles*, double*) {}), IsEmpty());
  for (const std::string name : {"plastic", "felt", "copper", "rubber"}) {
    const TestDirectory directory;
    WriteMeasurement(LoadMeasurement("synth:" + name + "@30x30x60", {.missing = 0.9}),
                     directory.Path("x.csv"));
    EXPECT_THAT(SymptomsOfSamples(LoadMeasurement(directory.Path("x.csv"))), IsEmpty()) << name;
  }
}

TEST(SampleSymptoms, ACosineIsToldInBothReadings) {
  EXPECT_THAT(Told([](SphericalAngles* at, double* rho) { *rho *= std::cos(at->theta_o); }),
              ElementsAre(AllOf(HasSubstr("--cosine=o:1"), HasSubstr("--cosine=-1"))));
  EXPECT_THAT(Told([](SphericalAngles* at, double* rho) { *rho *= std::cos(at->theta_i); }),
              ElementsAre(AllOf(HasSubstr("--cosine=1"), HasSubstr("--cosine=o:-1"))));
}

TEST(SampleSymptoms, AHighlightTowardsTheLightIsTold) {
  EXPECT_THAT(Told([](SphericalAngles* at, double*) {
                at->phi_o = std::remainder(at->phi_o + kPi, 2 * kPi);
              }),
              ElementsAre(AllOf(HasSubstr("--azimuth=from_mirror"), HasSubstr("4 of 4"))));
  EXPECT_THAT(Told([](SphericalAngles* at, double* rho) {
                const SphericalAngles real = {.theta_i = at->theta_i,
                                              .phi_i = 0,
                                              .theta_o = std::abs(at->theta_i - at->theta_o),
                                              .phi_o = kPi};
                *rho = std::cos(at->phi_o) < -0.9 ? Glossy(real) : 0.05;
                if (at->theta_o == 0) *rho = 1 + 0.01 * at->phi_o + at->theta_i;
              }),
              ElementsAre(HasSubstr("theta_o seems to be counted from the mirror direction")));
}

// A scan of a satin material at four incidences, whose lobes have no clear highlight;
// `from_mirror`: as if theta_o were counted from there.
Measurement SatinScans(bool from_mirror, double cosines = 0) {
  SampleCollector collector("x.csv", "test");
  for (const double theta_i : {10.0, 30.0, 50.0, 70.0}) {
    for (int from = -60; from <= 60; from += 3) {
      const double theta_o = from + (from_mirror ? theta_i : 0);
      if (std::abs(theta_o) > 85) continue;
      const auto at = [&](double theta) {
        return SphericalAngles{.theta_i = DegreesToRadians(theta_i),
                               .phi_i = 0,
                               .theta_o = DegreesToRadians(std::abs(theta)),
                               .phi_o = theta > 0 ? kPi : 0};
      };
      const HalfDiffAngles half = ToHalfDiff(ToDirections(at(theta_o)));
      const double rho =
          (0.1 + (0.3 + half.theta_d) * std::exp(-half.theta_h * half.theta_h / 0.3)) *
          std::pow(std::cos(at(theta_o).theta_o), cosines);
      collector.Add(at(from), {rho, rho, rho});
    }
  }
  return collector.Take();
}

TEST(SampleSymptoms, ThetaFromTheMirrorDirectionIsToldOfSatin) {
  EXPECT_THAT(SymptomsOfSamples(SatinScans(true)),
              ElementsAre(HasSubstr("theta_o seems to be counted from the mirror direction")));
  EXPECT_THAT(SymptomsOfSamples(SatinScans(false)), IsEmpty());
  EXPECT_FALSE(FromMirrorOf(SatinScans(false, 1).samples).IsThere());
  EXPECT_TRUE(FromMirrorOf(SatinScans(false).samples).is_decided);
}

// Writes a wide highlight with angles from the horizon.
void WriteElevations(SphericalAngles* at, double* rho) {
  const double theta_h = ToHalfDiff(ToDirections(*at)).theta_h;
  *rho = 0.02 + 0.5 * std::exp(-theta_h * theta_h / 0.2);
  at->theta_i = kPi / 2 - at->theta_i;
  at->theta_o = kPi / 2 - at->theta_o;
}

// A glossy material at polar angles from 10 to 80 degrees, the angles as they are or elevations.
Measurement Selected10To80(bool as_elevations) {
  SampleCollector collector("x.csv", "test");
  for (const double theta_i : {10.0, 30.0, 50.0, 70.0}) {
    for (int theta_o = 10; theta_o <= 80; theta_o += 10) {
      for (int phi = 0; phi < 360; phi += 30) {
        SphericalAngles at = {.theta_i = DegreesToRadians(theta_i),
                              .phi_i = 0,
                              .theta_o = DegreesToRadians(theta_o),
                              .phi_o = DegreesToRadians(phi)};
        const double theta_h = ToHalfDiff(ToDirections(at)).theta_h;
        const double rho = 0.02 + 0.5 * std::exp(-theta_h * theta_h / 0.2);
        if (as_elevations) {
          at.theta_i = kPi / 2 - at.theta_i;
          at.theta_o = kPi / 2 - at.theta_o;
        }
        collector.Add(at, {rho, rho, rho});
      }
    }
  }
  return collector.Take();
}

// Light from several azimuths hides no fault.
// The samples of one theta_i.
Measurement OneIncidence(double theta_i, Measurement measurement) {
  std::vector<int> numbers;
  for (int j = 0; j < measurement.samples.size(); ++j) {
    if (std::abs(measurement.samples.directions[j].theta_i - theta_i) < 1e-6) numbers.push_back(j);
  }
  measurement.samples = Selected(measurement.samples, numbers);
  return measurement;
}

TEST(SampleSymptoms, OneIncidenceTellsIfItsHighlightIsStrong) {
  const auto turn = [](SphericalAngles* at, double* rho) {
    at->phi_o = std::remainder(at->phi_o + kPi, 2 * kPi);
    *rho *= *rho;
  };
  const double theta_i = DegreesToRadians(45);
  EXPECT_THAT(SymptomsOfSamples(OneIncidence(theta_i, Goniometer(turn))),
              ElementsAre(AllOf(HasSubstr("--azimuth=from_mirror"), HasSubstr("1 of 1"))));
  const auto keep = [](SphericalAngles*, double*) {};
  EXPECT_THAT(SymptomsOfSamples(OneIncidence(theta_i, Goniometer(keep))), IsEmpty());
  // A weak one may be chance.
  const auto turn_weak = [&](SphericalAngles* at, double* rho) {
    turn(at, rho);
    *rho = 0.1 * std::pow(*rho, 0.2);
  };
  EXPECT_THAT(SymptomsOfSamples(OneIncidence(theta_i, Goniometer(turn_weak))), IsEmpty());
}

TEST(SampleSymptoms, WhatCannotBeCheckedIsSaid) {
  const auto keep = [](SphericalAngles*, double*) {};
  const Measurement whole = Goniometer(keep);
  EXPECT_EQ(UndecidedIn(whole), "");
  const std::string one = UndecidedIn(OneIncidence(DegreesToRadians(45), whole));
  EXPECT_THAT(one, AllOf(HasSubstr("cosines (few exchanged directions)"), HasSubstr("elevations")));
  const auto flatten = [](SphericalAngles*, double* rho) { *rho = 0.2; };
  EXPECT_THAT(UndecidedIn(Goniometer(flatten)),
              testing::StartsWith("where azimuths are counted from"));
}

TEST(SampleSymptoms, TurnedSamplesAreToldAsOthersAre) {
  const auto told = [](const auto& change) {
    SampleCollector collector("x.csv", "test");
    const BrdfSamples samples = Goniometer(change).samples;
    for (const double turn : {0.0, kPi / 2, 2.0}) {
      for (int j = 0; j < samples.size(); ++j) {
        SphericalAngles at = samples.directions[j];
        at.phi_i += turn;
        at.phi_o += turn;
        collector.Add(at, samples.rho[j]);
      }
    }
    const Measurement turned = collector.TakeByAzimuths();
    EXPECT_TRUE(turned.anisotropic);
    return SymptomsOfSamples(turned);
  };
  EXPECT_THAT(told([](SphericalAngles*, double*) {}), IsEmpty());
  EXPECT_THAT(told([](SphericalAngles* at, double* rho) { *rho *= std::cos(at->theta_o); }),
              ElementsAre(HasSubstr("--cosine=o:1")));
  EXPECT_THAT(told([](SphericalAngles* at, double*) {
                at->phi_o = std::remainder(at->phi_o + kPi, 2 * kPi);
              }),
              ElementsAre(HasSubstr("--azimuth=from_mirror")));
  EXPECT_THAT(told(WriteElevations), ElementsAre(HasSubstr("angles seem to be elevations")));
}

TEST(SampleSymptoms, OfCleanAnisotropicMaterialsThereAreNone) {
  for (const std::string name :
       {"linen", "charmeuse", "shot_silk", "rolled_brass", "rolled_aluminium", "brushed_aluminium",
        "varnished_plywood", "enamelled_metal", "aniso_ggx_steel", "aniso_ggx_gold",
        "aniso_ggx_lacquer"}) {
    for (const std::string grid : {"@6x24", "@9x36"}) {
      const Measurement clean = LoadMeasurement("synth:" + name + grid, {.noise = 0.02});
      EXPECT_THAT(SymptomsOfSamples(clean), IsEmpty()) << name << grid;
    }
  }
}

TEST(SampleSymptoms, MoreLightThanFellIsTold) {
  for (const ReflectedAtLeast& one :
       ReflectedLightOf(Goniometer([](SphericalAngles*, double* rho) { *rho = 0.2; }).samples)) {
    // The samples reach 80 degrees, plus half a step of 5.
    EXPECT_GT(one.albedo, 0.2 * kPi * 0.95);
    EXPECT_LT(one.albedo, 0.2 * kPi * 1.001);
  }
  EXPECT_THAT(Told([](SphericalAngles*, double* rho) { *rho *= 100; }),
              ElementsAre(HasSubstr("--scale=0.01")));
  EXPECT_THAT(Told([](SphericalAngles*, double* rho) { *rho = 0.2 * kPi; }),
              ElementsAre(HasSubstr("--scale=0.318")));
}

// All but the plane of incidence.
Measurement InPlane(double scale) {
  return Goniometer(
      [&](SphericalAngles* at, double* rho) {
        if (std::abs(std::sin(at->phi_o)) > 0.1) at->theta_o = kPi;  // below the surface
        *rho = scale * (Glossy(*at) - 0.045);
      },
      /*step_deg=*/180);
}

TEST(SampleSymptoms, ScansOfOnePlaneTellOfMoreLightThanFell) {
  // A diffuse part of 0.0157, and a highlight beside it.
  const double albedo = ReflectedLightOfScans(InPlane(1).samples);
  EXPECT_GT(albedo, 0.0157);
  EXPECT_LT(albedo, 0.2);
  EXPECT_NEAR(ReflectedLightOfScans(InPlane(100).samples), 100 * albedo, 1e-9);
  EXPECT_THAT(SymptomsOfSamples(InPlane(1)), IsEmpty());
  EXPECT_THAT(SymptomsOfSamples(InPlane(100)), ElementsAre(HasSubstr("--scale=0.01")));
  // One side alone tells nothing.
  EXPECT_EQ(ReflectedLightOfScans(Goniometer([](SphericalAngles* at, double*) {
                                    if (std::cos(at->phi_o) > -0.9) at->theta_o = kPi;
                                  }).samples),
            0);
}

TEST(SampleSymptoms, ElevationsInThePlaceOfZenithAnglesAreTold) {
  EXPECT_THAT(Told(WriteElevations), ElementsAre(HasSubstr("angles seem to be elevations")));
}

TEST(SampleSymptoms, ADroppedSignIsTold) {
  const Measurement scan =
      Goniometer([](SphericalAngles* at, double*) { at->phi_o = 0; }, /*step_deg=*/180);
  EXPECT_THAT(SymptomsOfSamples(scan), ElementsAre(HasSubstr("the sign of an angle was dropped")));
}

TEST(SampleSymptoms, MarksAndPlateausAreTold) {
  int k = 0;
  EXPECT_THAT(Told([&](SphericalAngles*, double* rho) {
                if (++k % 50 == 0) *rho = 9999;
              }),
              testing::Contains(HasSubstr("the value 9999 is there")));
  EXPECT_THAT(Told([](SphericalAngles*, double* rho) { *rho = std::min(*rho, 0.3); }),
              ElementsAre(HasSubstr("a detector is saturated")));
}

// Near the normal they are the brightest samples, and all light is percents of them.
TEST(SampleSymptoms, MarksLeaveNothingElseToTell) {
  const auto mark = [](double times) {
    return Told([times](SphericalAngles* at, double* rho) {
      *rho = at->theta_o < 0.2 ? 9999 : times * *rho;
    });
  };
  EXPECT_THAT(mark(1), testing::ElementsAre(HasSubstr("the value 9999 is there")));
  EXPECT_THAT(mark(100), testing::ElementsAre(HasSubstr("the value 9999 is there"),
                                              HasSubstr("times as much light comes back")));
}

TEST(SampleSymptoms, NinesAreAMarkBesideValuesAsLarge) {
  int k = 0;
  EXPECT_THAT(Told([&](SphericalAngles*, double* rho) {
                *rho *= 5000;
                if (++k % 50 == 0) *rho = 9999;
              }),
              testing::Contains(HasSubstr("the value 9999 is there")));
}

TEST(SampleSymptoms, APlateauOfSignalsMayStandAtOneHalfAngle) {
  EXPECT_THAT(Told([](SphericalAngles* at, double* rho) {
                *rho = std::min(*rho, 0.15 / std::cos(at->theta_i));
              }),
              ElementsAre(HasSubstr("a detector is saturated")));
}

TEST(SampleSymptoms, RadiansAndDecibelsAreTold) {
  EXPECT_THAT(Told([](SphericalAngles* at, double*) {
                at->theta_i = DegreesToRadians(at->theta_i);
                at->theta_o = DegreesToRadians(at->theta_o);
              }),
              testing::Contains(HasSubstr("in radians")));
  EXPECT_THAT(Told([](SphericalAngles*, double* rho) { *rho = 10 * std::log10(*rho); }),
              testing::Contains(HasSubstr("as decibels are")));
}

TEST(SampleSymptoms, CorrectionsGiveTheValuesBack) {
  const TestDirectory directory;
  const Measurement truth = Goniometer([](SphericalAngles*, double*) {});
  const auto corrected = [&](const Measurement& wrong, const SourceOptions& options) {
    WriteMeasurement(wrong, directory.Path("x.csv"));
    return LoadMeasurement(directory.Path("x.csv"), options).samples;
  };
  const auto expect_truth = [&](const BrdfSamples& samples) {
    ASSERT_EQ(samples.size(), truth.samples.size());
    for (int j = 0; j < samples.size(); ++j) {
      EXPECT_NEAR(samples.rho[j][1], Glossy(samples.directions[j]), 1e-5);
    }
  };
  expect_truth(
      corrected(Goniometer([](SphericalAngles* at, double* rho) { *rho *= std::cos(at->theta_o); }),
                {.cosine_o = 1}));
  expect_truth(
      corrected(Goniometer([](SphericalAngles*, double* rho) { *rho *= 100; }), {.scale = 0.01}));
  expect_truth(corrected(Goniometer([](SphericalAngles* at, double*) {
                           at->phi_o = std::remainder(at->phi_o + kPi, 2 * kPi);
                         }),
                         {.azimuth_from_mirror = true}));
}

TEST(SampleSymptoms, TheCosineIsGivenByAText) {
  const SourceOption& cosine = FindSourceOption("cosine");
  SourceOptions options;
  cosine.set("o:-1", &options);
  cosine.set("i:0.5", &options);
  EXPECT_EQ(options.cosine_o, -1);
  EXPECT_EQ(options.cosine, 0.5);
  cosine.set("2", &options);
  EXPECT_EQ(options.cosine, 2);
  for (const char* const text : {"", "o:", "x:1", "1x"}) {
    EXPECT_THAT(ErrorOf([&] { cosine.set(text, &options); }),
                IsError(ErrorKind::kFormat, {.key = "cosine"}))
        << text;
  }
}

TEST(SampleSymptoms, AzimuthsInRadiansAreTold) {
  const auto shrink = [](SphericalAngles* at, double*) { at->phi_o = DegreesToRadians(at->phi_o); };
  EXPECT_THAT(Told(shrink), ElementsAre(HasSubstr("as phi_o_rad")));
}

// Sharp highlights, and all azimuths at the normal, on a coarse grid.
TEST(SampleSymptoms, CleanCoarseGridsHaveNone) {
  for (const double width : {0.0005, 0.005, 0.02, 0.2}) {
    SampleCollector collector("x.csv", "test");
    for (const double theta_i : {0.0, 15.0, 30.0, 45.0, 60.0}) {
      for (int theta_o = 0; theta_o <= 75; theta_o += 15) {
        for (int phi = 0; phi < 360; phi += 30) {
          const SphericalAngles at = {.theta_i = DegreesToRadians(theta_i),
                                      .phi_i = 0,
                                      .theta_o = DegreesToRadians(theta_o),
                                      .phi_o = DegreesToRadians(phi)};
          const HalfDiffAngles half = ToHalfDiff(ToDirections(at));
          const double rho = 0.02 + 0.02 * (1 + half.theta_d) / width *
                                        std::exp(-half.theta_h * half.theta_h / width);
          collector.Add(at, {rho, rho, rho});
        }
      }
    }
    EXPECT_THAT(SymptomsOfSamples(collector.Take()), IsEmpty()) << width;
  }
}

TEST(SampleSymptoms, ElevationsAreToldWithoutTheNormal) {
  const auto told = [](bool as_elevations) {
    return SymptomsOfSamples(Selected10To80(as_elevations));
  };
  EXPECT_THAT(told(false), IsEmpty());
  EXPECT_THAT(told(true), ElementsAre(HasSubstr("angles seem to be elevations")));
}

TEST(SampleSymptoms, TheSharedCasesAreTold) {
  const std::string folder = MeasuredData("../cases/");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  const auto told = [&](const std::string& name) {
    return SymptomsOfSamples(LoadMeasurement(folder + name));
  };
  EXPECT_THAT(told("good.csv"), IsEmpty());
  EXPECT_THAT(told("cosine.csv"), ElementsAre(HasSubstr("--cosine=o:1")));
  EXPECT_THAT(told("phi0_is_specular.csv"), ElementsAre(HasSubstr("--azimuth=from_mirror")));
  EXPECT_THAT(told("turned_cosine.csv"), ElementsAre(HasSubstr("--cosine=o:1")));
  EXPECT_THAT(told("one_incidence_from_mirror.csv"),
              ElementsAre(HasSubstr("--azimuth=from_mirror")));
  EXPECT_THAT(told("turned_from_mirror.csv"), ElementsAre(HasSubstr("--azimuth=from_mirror")));
  EXPECT_THAT(told("specular_relative_satin.csv"), ElementsAre(HasSubstr("from_mirror=NAME")));
  EXPECT_THAT(told("percent.csv"), ElementsAre(HasSubstr("--scale=0.01")));
  EXPECT_THAT(told("radians.csv"), testing::Contains(HasSubstr("in radians")));
  EXPECT_THAT(told("sign_dropped.csv"), ElementsAre(HasSubstr("the sign of an angle")));
  EXPECT_EQ(LoadMeasurement(folder + "retro.csv").counts.valid, 2310);
  EXPECT_THAT(told("retro.csv"), ElementsAre(HasSubstr("for which the model has no lobe")));
  const Measurement shadow = LoadMeasurement(folder + "shadow_zero.csv");
  EXPECT_GE(shadow.counts.missing, 22);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
