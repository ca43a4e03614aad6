#include <gtest/gtest.h>

#include <limits>

#include "model/appearance/node_appearance.h"
#include "model/appearance/picture_data.h"
#include "tests/test_directory.h"
#include "trilobe/io/formats/source.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

AppearanceOptions Quick(int num_threads = 1) {
  return {.lights = 40, .size = 12, .num_threads = num_threads};
}

SphericalBrdf Times(const SphericalBrdf& brdf, double factor) {
  return [brdf, factor](const SphericalAngles& at) {
    Rgb rho = brdf(at);
    for (double& x : rho) x *= factor;
    return rho;
  };
}

TEST(NodeJudge, PutsTheNearestFirst) {
  const Measurement measured = LoadMeasurement("synth:linen@6x12");
  const PictureData data = PictureDataOf(measured);
  const SphericalBrdf linen = [&](const SphericalAngles& at) {
    return measured.formula(ToDirections(at));
  };
  const NodeJudge judge(*data.nodes, Times(linen, 1.01), Quick());
  EXPECT_GT(judge(linen), judge(Times(linen, 1.05)));
  EXPECT_GT(judge(Times(linen, 1.05)), judge(Times(linen, 1.3)));
  EXPECT_EQ(judge(std::cref(*data.nodes)), std::numeric_limits<double>::infinity());
  EXPECT_EQ(judge(linen), NodeJudge(*data.nodes, Times(linen, 1.01), Quick(3))(linen));
}

// Interpolation between narrow highlights 15 degrees apart is wrong, and a model nearer to it is no
// better.
TEST(NodeJudge, DoesNotTakeInterpolationForTheMaterial) {
  const Measurement measured = LoadMeasurement("synth:rolled_brass@6x24");
  const PictureData data = PictureDataOf(measured);
  const SphericalBrdf brass = [&](const SphericalAngles& at) {
    return measured.formula(ToDirections(at));
  };
  const SphericalBrdf between = [&](const SphericalAngles& at) {
    Rgb rho = brass(at), interpolated = (*data.nodes)(at);
    for (int c = 0; c < kChannels; ++c) rho[c] = 0.9 * (0.7 * rho[c] + 0.3 * interpolated[c]);
    return rho;
  };
  const NodeJudge judge(*data.nodes, Times(brass, 0.99), Quick());
  EXPECT_GT(judge(brass), judge(between));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
