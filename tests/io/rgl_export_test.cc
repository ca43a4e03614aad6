#include "trilobe/io/rgl_export.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "tests/evaluate/materials.h"
#include "tests/test_util.h"
#include "trilobe/base/error.h"
#include "trilobe/io/rgl_file.h"
#include "trilobe/io/tensor_file.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

using ::testing::ElementsAre;

FactorModel Plastic() { return AnalyticModel(ModelSpec::SharedFactors(3), 0.1, 0.4); }

TEST(RglExport, IsTheModelWhereOurReaderLooks) {
  const FactorModel model = Plastic();
  const RglExport file = ExportRgl(model);
  EXPECT_LE(file.median_error, 0.005);
  EXPECT_LE(file.bytes.size(), 2300000U);
  const RglBrdf brdf = RglBrdf::Parse(file.bytes, "plastic.bsdf");
  EXPECT_TRUE(brdf.isotropic());
  Random random(1);
  std::vector<double> errors;
  for (int k = 0; k < 1000; ++k) {
    const DirectionPair pair = {DirectionAt(random.Uniform(0, 1.2), random.Uniform(-kPi, kPi)),
                                DirectionAt(random.Uniform(0, 1.2), random.Uniform(-kPi, kPi))};
    errors.push_back(RelativeDistance(brdf.Evaluate(pair), Evaluate(model, pair)));
  }
  std::ranges::sort(errors);
  EXPECT_LT(errors[500], 0.005);
  EXPECT_LT(errors[990], 0.1);
}

// What Mitsuba 3 and powitacq_rgb ask for, field by field.
TEST(RglExport, HasTheFieldsThatRenderersRead) {
  const RglExport exported = ExportRgl(Plastic(), {.max_error = 1});
  const TensorFile file(exported.bytes, "plastic.bsdf");
  const int t = exported.theta_i, n = exported.resolution;
  EXPECT_EQ(file.Byte("jacobian"), 1);
  EXPECT_FALSE(file.Bytes("description").empty());
  EXPECT_THAT(file.Float32("phi_i", 1).shape, ElementsAre(1));
  const Tensor theta = file.Float32("theta_i", 1);
  EXPECT_THAT(theta.shape, ElementsAre(t));
  EXPECT_EQ(theta.values.front(), 0);
  EXPECT_NEAR(theta.values.back(), kPi / 2, 1e-6);
  EXPECT_THAT(file.Float32("rgb", 5).shape, ElementsAre(1, t, 3, n, n));
  EXPECT_THAT(file.Float32("luminance", 4).shape, ElementsAre(1, t, n, n));
  EXPECT_THAT(file.Float32("vndf", 4).shape, ElementsAre(1, t, 2, 361));
  for (const char* name : {"ndf", "sigma"}) {
    for (const double x : file.Float32(name, 2).values) EXPECT_GT(x, 0);
  }
  for (const double x : file.Float32("luminance", 4).values) EXPECT_GE(x, 0);
}

TEST(RglExport, TakesAnisotropicModelsAroundTheWholeCircle) {
  const RglExport file =
      ExportRgl(AnalyticModel(ModelSpec::Anisotropic(2), 0.3, 0.2), {.max_error = 0.2});
  EXPECT_LE(file.median_error, 0.2);
  const std::vector<double> phi = TensorFile(file.bytes, "cloth.bsdf").Float32("phi_i", 1).values;
  EXPECT_NEAR(phi.back() - phi.front(), 2 * kPi, 1e-5);
  EXPECT_FALSE(RglBrdf::Parse(file.bytes, "cloth.bsdf").isotropic());
}

TEST(RglExport, TakesFinerTablesForLessError) {
  const FactorModel model = Plastic();
  const RglExport coarse = ExportRgl(model, {.max_error = 0.05}), fine = ExportRgl(model);
  EXPECT_LT(coarse.bytes.size(), fine.bytes.size());
  EXPECT_GT(coarse.median_error, fine.median_error);
  EXPECT_THROW(ExportRgl(model, {.max_error = 0}), Error);
}

TEST(RglExport, RefusesABlackModel) {
  EXPECT_THROW(ExportRgl(FactorModel(ModelSpec::SharedFactors(1))), Error);
  EXPECT_THROW(ExportRgl(FactorModel(ModelSpec::Anisotropic(1))), Error);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
