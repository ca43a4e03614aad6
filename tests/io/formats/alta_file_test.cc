#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::ElementsAre;

std::string Head(const std::string& dim, const std::string& input, const std::string& output) {
  return "#ALTA_BEGIN_HEADER\n#DIM " + dim + "\n#PARAM_IN " + input + "\n#PARAM_OUT " + output +
         "\n#ALTA_END_HEADER\n";
}

Measurement Parse(const std::string& text) { return ReadAs("alta", text, "x.alta"); }
std::optional<Error> ParseError(const std::string& text) {
  return ErrorOf([&] { Parse(text); });
}

// Coordinates of a pair of directions in a parametrisation.
using Numbers = std::function<std::vector<double>(const SphericalAngles&, const DirectionPair&)>;

std::vector<SphericalAngles> Pairs(bool anisotropic) {
  std::vector<SphericalAngles> pairs;
  for (const double theta_i : {0.1, 0.8}) {
    for (const double theta_o : {0.3, 1.2}) {
      for (const double phi_o : {0.2, 3.0}) {
        for (const double phi_i : {0.0, 0.7}) {
          if (phi_i == 0 || anisotropic) pairs.push_back({theta_i, phi_i, theta_o, phi_o});
        }
      }
    }
  }
  return pairs;
}

std::string Rows(const Numbers& numbers, bool anisotropic,
                 const std::function<std::vector<double>(const SphericalAngles&)>& values) {
  std::string text;
  for (const SphericalAngles& at : Pairs(anisotropic)) {
    for (const double number : numbers(at, ToDirections(at))) text += Text(number) + " ";
    for (const double value : values(at)) text += Text(value) + " ";
    text += "\n";
  }
  return text;
}

Rgb TruthAt(const SphericalAngles& at, bool anisotropic) {
  return TrueMaterial(anisotropic).brdf(ToDirections(at));
}

TEST(AltaFile, ReadsBackAKnownMaterial) {
  struct Case {
    const char *input, *dim;
    bool anisotropic;
    Numbers numbers;
  };
  const auto half = [](const DirectionPair& pair) { return ToHalfDiff(pair); };
  const Case cases[] = {
      {"ISOTROPIC_TV_TL_DPHI", "3", false,
       [](const SphericalAngles& at, const DirectionPair&) {
         return std::vector{at.theta_o, at.theta_i, at.phi_o};
       }},
      {"ISOTROPIC_TL_TV_PROJ_DPHI", "3", false,
       [](const SphericalAngles& at, const DirectionPair&) {
         return std::vector{at.theta_i, at.theta_o * std::cos(at.phi_o),
                            at.theta_o * std::sin(at.phi_o)};
       }},
      {"RUSIN_TH_TD_PD", "3", false,
       [&](const SphericalAngles&, const DirectionPair& pair) {
         return std::vector{half(pair).theta_h, half(pair).theta_d, half(pair).phi_d};
       }},
      {"SPHERICAL_TL_PL_TV_PV", "4", true,
       [](const SphericalAngles& at, const DirectionPair&) {
         return std::vector{at.theta_i, at.phi_i, at.theta_o, at.phi_o};
       }},
      {"CARTESIAN", "6", true,
       [](const SphericalAngles&, const DirectionPair& pair) {
         std::vector<double> numbers(pair.wo.begin(), pair.wo.end());
         numbers.insert(numbers.end(), pair.wi.begin(), pair.wi.end());
         return numbers;
       }},
  };
  for (const auto& [input, dim, anisotropic, numbers] : cases) {
    SCOPED_TRACE(input);
    const std::string text =
        Head(std::string(dim) + " 3", input, "RGB_COLOR") +
        Rows(numbers, anisotropic, [anisotropic = anisotropic](const SphericalAngles& at) {
          const Rgb rho = TruthAt(at, anisotropic);
          return std::vector(rho.begin(), rho.end());
        });
    const Measurement measurement = Source("any", text).Read({.min_theta_d_deg = 0});
    EXPECT_EQ(measurement.kind, "ALTA file of scattered samples");
    EXPECT_EQ(measurement.counts.valid, anisotropic ? 16 : 8);
    EXPECT_EQ(measurement.anisotropic, anisotropic);
    ExpectTruth(measurement, /*grey=*/false, anisotropic);
  }
}

// The half vector turned about the normal turns both directions.
TEST(AltaFile, AnisotropicHalfVectors) {
  const Measurement measurement =
      Parse(Head("4 1", "RUSIN_TH_PH_TD_PD", "INV_STERADIAN") + "0.3 0.4 0.5 0.6 1\n");
  const auto [wi, wo] = ToDirections(measurement.samples.directions.at(0));
  const PolarAngles half = HalfVector({wi, wo});
  EXPECT_NEAR(half.theta, 0.3, 1e-12);
  EXPECT_NEAR(half.phi, 0.4, 1e-12);
  EXPECT_NEAR(ToHalfDiff({wi, wo}).theta_d, 0.5, 1e-12);
  EXPECT_NEAR(ToHalfDiff({wi, wo}).phi_d, 0.6, 1e-12);
}

TEST(AltaFile, WhatValuesMayBe) {
  const auto angles = [](const SphericalAngles& at, const DirectionPair&) {
    return std::vector{at.theta_o, at.theta_i, at.phi_o};
  };
  const Measurement cosine =
      Parse(Head("3 1", "ISOTROPIC_TV_TL_DPHI", "INV_STERADIAN_COSINE_FACTOR") +
            Rows(angles, false, [](const SphericalAngles& at) {
              return std::vector{TruthAt(at, false)[1] * std::cos(at.theta_o)};
            }));
  ExpectTruth(cosine, /*grey=*/true);
  EXPECT_THAT(cosine.notes, ElementsAre("read as: f cos theta_o, divided by cos theta_o"));
  const Measurement grey = Parse(Head("3 3", "ISOTROPIC_TV_TL_DPHI", "XYZ_COLOR") +
                                 Rows(angles, false, [](const SphericalAngles& at) {
                                   return std::vector(3, TruthAt(at, false)[1]);
                                 }));
  ExpectTruth(grey, /*grey=*/true, /*anisotropic=*/false, 1e-5);
}

std::string Binary(const std::vector<double>& numbers, const std::string& samples,
                   const std::string& endian = "little") {
  std::string bytes(numbers.size() * sizeof(double), '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return "#DIM 3 1\n#PARAM_IN  ISOTROPIC_TV_TL_DPHI\n#PARAM_OUT INV_STERADIAN\n#FORMAT binary\n"
         "#VERSION 0\n#PRECISION ieee754-double\n#SAMPLE_COUNT " +
         samples + "\n#VS 1\n#ENDIAN " + endian + "\n#BEGIN_STREAM\n" + bytes + "\n#END_STREAM\n";
}

TEST(AltaFile, BinaryFilesHaveConfidenceIntervals) {
  const std::vector<double> numbers = {0.1, 0.2, 3, 0.5, 9, 0.3, 0.2, 3, 0.7, 9};
  const Measurement measurement = Parse(Binary(numbers, "2"));
  ASSERT_EQ(measurement.samples.size(), 2);
  EXPECT_NEAR(measurement.samples.directions[1].theta_o, 0.3, 1e-12);
  EXPECT_EQ(measurement.samples.rho[1][0], 0.7);
  EXPECT_THAT(
      ParseError(Binary(numbers, "1000000000000")),
      IsError(ErrorKind::kFormat, {.file = "x.alta", .key = "SAMPLE_COUNT", .value = "1e+12"}));
  EXPECT_THAT(ParseError(Binary(numbers, "2", "big")),
              IsError(ErrorKind::kUnsupported, {.line = 9, .key = "#ENDIAN", .value = "big"}));
  EXPECT_THAT(ParseError(Binary({0.1, NAN, 3, 0.5, 9}, "1")),
              IsError(ErrorKind::kFormat, {.file = "x.alta", .key = "theta_l", .value = "1"}));
}

TEST(AltaFile, ErrorsSayWhereAndWhatIsExpected) {
  const std::string row = "0.2 0.3 3.14 0.11\n";
  EXPECT_THAT(ParseError(""), IsError(ErrorKind::kMissing, {.key = "#DIM"}));
  EXPECT_THAT(ParseError("#DIM 2 1\n#PARAM_IN RUSIN_TH_TD\n#PARAM_OUT INV_STERADIAN\n0 0 1\n"),
              IsError(ErrorKind::kUnsupported,
                      {.file = "x.alta", .line = 4, .key = "#PARAM_IN", .value = "RUSIN_TH_TD"}));
  EXPECT_THAT(ParseError(Head("3 1", "ISOTROPIC_TV_TL_DPHI", "ENERGY") + row),
              IsError(ErrorKind::kFormat, {.line = 6}));
  EXPECT_THAT(ParseError(Head("4 1", "ISOTROPIC_TV_TL_DPHI", "INV_STERADIAN") + row),
              IsError(ErrorKind::kMismatch, {.line = 6, .key = "#DIM", .value = "4 1"}));
  EXPECT_THAT(ParseError(Head("3 x", "ISOTROPIC_TV_TL_DPHI", "INV_STERADIAN") + row),
              IsError(ErrorKind::kFormat, {.line = 2}));
  const std::string head = Head("3 1", "ISOTROPIC_TV_TL_DPHI", "INV_STERADIAN");
  EXPECT_THAT(ParseError(head), IsError(ErrorKind::kMissing, {.line = 5, .key = "samples"}));
  EXPECT_THAT(ParseError(head + "0.2 0.3 3.14\n"),
              IsError(ErrorKind::kFormat, {.line = 6, .key = "columns", .value = "3"}));
  EXPECT_THAT(ParseError(head + row + "0.2 x 3.14 1\n"),
              IsError(ErrorKind::kFormat, {.line = 7, .key = "theta_l", .value = "x"}));
  EXPECT_THAT(ParseError(head + "20 30 180 1\n"),
              IsError(ErrorKind::kRange, {.line = 6, .key = "theta_v", .value = "20"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
