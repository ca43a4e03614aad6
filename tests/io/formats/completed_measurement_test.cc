#include "io/formats/completed_measurement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/error_of.h"
#include "tests/io/formats/read_as.h"
#include "tests/model/materials.h"
#include "tests/test_util.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

const FactorModel& Model() {
  static const FactorModel model = AnalyticModel(ModelSpec::SharedFactors(2), 0.2, 0.3);
  return model;
}

// At the centres of bins it is what was measured, though the model says something else.
TEST(Complete, IsTheMeasurementWhereThatIs) {
  const Measurement foam = LoadMeasurement("synth:foam@30x30x60", {.noise = 0.3});
  const CompletedMeasurement completed = Complete(foam, Model(), 2);
  EXPECT_TRUE(completed.interpolated);
  ASSERT_GT(completed.places.size(), 10000U);
  for (const CompletedMeasurement::Place& place : completed.places) {
    EXPECT_LT(RelativeDistance(completed.value(place.at), place.measured), 1e-9);
    EXPECT_GT(Mean(place.measured), 0);
  }
}

TEST(Complete, IsTheModelWhereNothingWasMeasured) {
  Measurement foam = LoadMeasurement("synth:foam@30x30x60");
  LimitAngles(DegreesToRadians(40), &foam);
  const CompletedMeasurement completed = Complete(foam, Model(), 1);
  const DirectionPair beyond = ToDirections(SphericalAngles{1.2, 0.3, 1.1, 2.0});
  EXPECT_LT(RelativeDistance(completed.value(beyond), Evaluate(Model(), beyond)), 1e-9);
  for (const CompletedMeasurement::Place& place : completed.places) {
    EXPECT_GE(std::min(place.at.wi[2], place.at.wo[2]), std::cos(DegreesToRadians(40)) - 1e-12);
  }
}

// For a model's own values the ratio is 1, so that the result is the model between bins, too, where
// a table alone would cut highlights off.
TEST(Complete, BendsBetweenPlacesAsTheModelDoes) {
  const Measurement own = {
      .source = "own", .kind = "test", .table = Reconstruct(Model(), "own", MerlGrid{30, 30, 60})};
  const CompletedMeasurement completed = Complete(own, Model(), 1);
  Random random(1);
  for (int k = 0; k < 1000; ++k) {
    const DirectionPair pair = {DirectionAt(random.Uniform(0, 1.2), random.Uniform(-kPi, kPi)),
                                DirectionAt(random.Uniform(0, 1.2), random.Uniform(-kPi, kPi))};
    EXPECT_LT(RelativeDistance(completed.value(pair), Evaluate(Model(), pair)), 0.02);
  }
}

TEST(Complete, TakesAnisotropicMeasurementsAtNodes) {
  const Measurement velvet = LoadMeasurement("synth:velvet");
  const FactorModel model = AnalyticModel(ModelSpec::Anisotropic(2), 0.3, 0.2);
  const CompletedMeasurement completed = Complete(velvet, model, 1);
  EXPECT_TRUE(completed.interpolated);
  ASSERT_GT(completed.places.size(), 1000U);
  for (const CompletedMeasurement::Place& place : completed.places) {
    EXPECT_LT(RelativeDistance(completed.value(place.at), place.measured), 1e-4);
  }
}

TEST(Complete, IsTheModelForSamplesOnNoGrid) {
  const Measurement scattered = ReadAs(
      "csv",
      "theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,20,100,0.1,0.2,0.3\n31,0,42,180,0.3,0.2,0.1\n",
      "two.csv");
  const CompletedMeasurement completed = Complete(scattered, Model(), 1);
  EXPECT_FALSE(completed.interpolated);
  ASSERT_FALSE(completed.places.empty());
  const DirectionPair& at = completed.places.front().at;
  EXPECT_LT(RelativeDistance(completed.value(at), Evaluate(Model(), at)), 1e-9);
}

TEST(Complete, RefusesAnAnisotropicModelOfATable) {
  const Measurement foam = LoadMeasurement("synth:foam@30x30x60");
  const FactorModel model = AnalyticModel(ModelSpec::Anisotropic(1), 0.3, 0.2);
  EXPECT_THAT(ErrorOf([&] { Complete(foam, model, 1); }),
              IsError(ErrorKind::kUnsupported, {.key = "anisotropic"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
