#include "io/formats/exports/open_material_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/known_truth.h"
#include "tests/io/formats/read_as.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using testing::HasSubstr;

ExportedBrdf Isotropic(const PairBrdf& value) {
  std::vector<CompletedMeasurement::Place> places;
  for (const double theta_i : {13.0, 41.0}) {
    for (const double theta_o : {7.0, 32.0, 58.0}) {
      for (const double phi : {5.0, 100.0, 170.0, 290.0}) {
        const DirectionPair pair = ToDirections(SphericalAngles{
            DegreesToRadians(theta_i), 0, DegreesToRadians(theta_o), DegreesToRadians(phi)});
        places.push_back({pair, value(pair)});
      }
    }
  }
  return {value, /*anisotropic=*/false, places};
}

TEST(OpenMaterialExport, OurReaderReadsBackTheMaterial) {
  const OpenMaterialExport file = ExportOpenMaterial(Isotropic(TrueMaterial(false).brdf), "x", 2);
  EXPECT_TRUE(file.colored);
  EXPECT_LT(file.median_error, 0.01);
  EXPECT_THAT(file.bytes, HasSubstr("\"name\":\"x\""));
  EXPECT_THAT(file.bytes, HasSubstr("\"wavelengths\": [4e-07,4.5e-07,5e-07"));
  const Measurement measurement = ReadAs("openmaterial", file.bytes, "x.xompt");
  EXPECT_FALSE(measurement.anisotropic);
  EXPECT_EQ(measurement.counts.total, file.incidences * file.zeniths * file.azimuths);
  EXPECT_EQ(measurement.counts.valid, measurement.counts.total);
  ExpectTruth(measurement, /*grey=*/false, /*anisotropic=*/false, /*tolerance=*/1e-3);
}

TEST(OpenMaterialExport, GreysHaveOneWavelength) {
  const OpenMaterialExport file = ExportOpenMaterial(Isotropic([](const DirectionPair& pair) {
                                                       const double value =
                                                           0.3 + 0.2 * Dot(pair.wi, pair.wo);
                                                       return Rgb{value, value, value};
                                                     }),
                                                     "\xff\"", 1);
  EXPECT_FALSE(file.colored);
  EXPECT_THAT(file.bytes, HasSubstr(R"("name":"\\xff\"")"));
  EXPECT_THAT(file.bytes, HasSubstr("\"wavelengths\": [5.5e-07]"));
  const Measurement measurement = ReadAs("openmaterial", file.bytes, "x.xompt");
  ASSERT_EQ(measurement.counts.total, file.incidences * file.zeniths * file.azimuths);
  for (int j = 0; j < measurement.samples.size(); j += 7) {
    const DirectionPair pair = ToDirections(measurement.samples.directions[j]);
    ASSERT_NEAR(measurement.samples.rho[j][1], 0.3 + 0.2 * Dot(pair.wi, pair.wo), 2e-6);
  }
}

// The schema of ASAM asks for rows sorted by their columns, in their ranges.
TEST(OpenMaterialExport, RowsAscend) {
  const OpenMaterialExport file = ExportOpenMaterial(Isotropic([](const DirectionPair& /*pair*/) {
                                                       return Rgb{0.25, 0.25, 0.25};
                                                     }),
                                                     "x", 1);
  const Measurement measurement = ReadAs("openmaterial", file.bytes, "x.xompt");
  const std::vector<SphericalAngles>& rows = measurement.samples.directions;
  for (size_t j = 1; j < rows.size(); ++j) {
    const auto key = [](const SphericalAngles& at) {
      return std::tuple(at.theta_i, at.theta_o, at.phi_o);
    };
    ASSERT_LT(key(rows[j - 1]), key(rows[j]));
    ASSERT_LT(rows[j].phi_o, 2 * kPi);
  }
}

TEST(OpenMaterialExport, AnisotropicOnesAreRefused) {
  ExportedBrdf brdf = Isotropic(TrueMaterial(true).brdf);
  brdf.anisotropic = true;
  EXPECT_THAT(ErrorOf([&] { ExportOpenMaterial(brdf, "x", 1); }),
              IsError(ErrorKind::kUnsupported, {.key = "anisotropic"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
