#include "experiments/sampling/ndf_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/model/half_vector_bins.h"
#include "tests/model/materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

struct TestCase {
  std::string name;
  FactorModel model;
  NdfSampler::Bins bins = NdfSampler::Bins::kOfModel;
};

std::vector<TestCase> TestCases() {
  std::vector<TestCase> cases;
  for (const auto& [name, model] : TestMaterials()) {
    cases.push_back({name, model});
    if (model.spec().anisotropic()) continue;
    cases.push_back({name + ", bins of one degree", model, NdfSampler::Bins::kOneDegree});
  }
  return cases;
}

TEST(NdfSamplerTest, DrawsWithItsDensityAndIsUnbiased) {
  constexpr int kDraws = kSanitized ? 2000 : 10000;
  for (const auto& [name, model, bins] : TestCases()) {
    const NdfSampler sampler(model, bins);
    const Bsdf<double> bsdf(model);
    for (const double degrees : {0.0, 45.0, 80.0}) {
      const Direction wi = DirectionAt(DegreesToRadians(degrees), 0.4);
      const std::string where = name + ", theta_i = " + std::to_string(degrees);
      Random random(3);
      std::vector<int> counts(HalfVectorBins::kCount);
      int above = 0;
      double sum = 0, squares = 0;
      for (int k = 0; k < kDraws; ++k) {
        const auto sample = sampler.SampleWo(wi, {random.Uniform(), random.Uniform()});
        if (!(sample.pdf > 0)) continue;
        ++above;
        ++counts[HalfVectorBins::Of(wi, sample.wo)];
        EXPECT_EQ(sampler.Pdf(wi, sample.wo), sample.pdf);
        sum += sample.weight[1];
        squares += sample.weight[1] * sample.weight[1];
      }
      std::vector<double> expected(HalfVectorBins::kCount);
      double total = 0;
      for (int bin = 0; bin < HalfVectorBins::kCount; ++bin) {
        expected[bin] = HalfVectorBins::Integral(
            wi, bin, [&](const Direction& wo) { return sampler.Pdf(wi, wo); });
        total += expected[bin];
      }
      // The remainder to 1 is below the horizon.
      EXPECT_LE(total, 1.02) << where;
      EXPECT_NEAR(total, static_cast<double>(above) / kDraws, 0.03) << where;
      for (double& x : expected) x *= above / total;
      EXPECT_LT(ChiSquared(counts, expected), 5) << where;
      // Highlights of which D is read elsewhere have weights without bound.
      if (model.spec().stretches.any() || name.starts_with("random numbers")) continue;
      const double mean = sum / kDraws, albedo = bsdf.Albedo(wi)[1];
      const double error = std::sqrt(std::max(squares / kDraws - mean * mean, 0.0) / kDraws);
      EXPECT_NEAR(mean, albedo, 5 * error + 0.05 * albedo) << where;
    }
  }
}

// A D that is 1 everywhere is drawn by the cosine of theta_h, whatever the bins: its sin^2 is
// uniform.
TEST(NdfSamplerTest, BinsHaveTheirTrueWidths) {
  FactorModel model(ModelSpec::SharedFactors(1));
  for (double& x : model.parameters()) x = 1;
  for (double& d : model.d()) d = 0;
  const Direction up = {0, 0, 1};
  for (const auto bins : {NdfSampler::Bins::kOfModel, NdfSampler::Bins::kOneDegree}) {
    const NdfSampler sampler(model, bins);
    for (const double u : {0.05, 0.1, 0.25, 0.4}) {
      const Direction wo = sampler.SampleWo(up, {u, 0.3}).wo;
      EXPECT_NEAR((1 - wo[2]) / 2, u, 1e-9);  // cos 2 theta_h = 1 - 2 sin^2 theta_h
    }
  }
}

// For a highlight of a fifth of a degree, bins of one degree draw most directions beside it.
TEST(NdfSamplerTest, BinsOfOneDegreeMissNarrowHighlights) {
  const FactorModel model = AnalyticModel(ModelSpec::SharedFactors(1), 0.003, 0);
  const auto within = [&model](NdfSampler::Bins bins) {
    const NdfSampler sampler(model, bins);
    Random random(5);
    int count = 0;
    for (int k = 0; k < 1000; ++k) {
      const Direction wo = sampler.SampleWo({0, 0, 1}, {random.Uniform(), random.Uniform()}).wo;
      count += wo[2] > std::cos(2 * DegreesToRadians(0.4));
    }
    return count;
  };
  EXPECT_GT(within(NdfSampler::Bins::kOfModel), 600);
  EXPECT_LT(within(NdfSampler::Bins::kOneDegree), 350);
  EXPECT_THAT(ErrorOf([&] {
                (NdfSampler{FactorModel(ModelSpec::Anisotropic(1)), NdfSampler::Bins::kOneDegree});
              }),
              IsError(ErrorKind::kUnsupported, {.key = "anisotropic"}));
}

TEST(NdfSamplerTest, LosesBelowTheHorizonWhatBsdfDoesNot) {
  const FactorModel model = AnalyticModel(ModelSpec::SharedFactors(3), 0.3, 0);
  const NdfSampler sampler(model);
  const Bsdf<double> bsdf(model);
  const Direction wi = DirectionAt(DegreesToRadians(85), 0);
  Random random(5);
  int lost = 0, lost_by_bsdf = 0;
  for (int k = 0; k < 4000; ++k) {
    const std::array<double, 2> u = {random.Uniform(), random.Uniform()};
    lost += !(sampler.SampleWo(wi, u).pdf > 0);
    lost_by_bsdf += !(bsdf.SampleWo(wi, u).pdf > 0);
  }
  EXPECT_GT(lost, 400);
  EXPECT_LT(lost_by_bsdf, 10);
}

TEST(NdfSamplerTest, HasAnAnswerForAnyNumbersAndDirections) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<NamedModel> models = TestMaterials();
  models.push_back({"black", FactorModel(ModelSpec::SharedFactors(2))});
  FactorModel one = AnalyticModel(ModelSpec::SharedFactors(2), 0.1, 0);
  for (double& x : one.table(Factor::kD, 0)) x = 0;
  one.table(Factor::kD, 0)[7] = 1;
  for (double& s : one.s(1)) s = 0;
  models.push_back({"one bin", one});
  for (const auto& [name, model] : models) {
    const NdfSampler sampler(model);
    for (const Direction& wi : {Direction{0, 0, 1}, Direction{1, 0, 1e-9}, Direction{0, 0, 0},
                                Direction{0.6, 0, -0.8}, Direction{nan, 0, 1}}) {
      for (const double u : {0.0, 1.0, -1.0, 2.0, 0.5, nan}) {
        const auto sample = sampler.SampleWo(wi, {u, 1 - u});
        bool fine = std::isfinite(sample.pdf) && sample.pdf >= 0;
        for (const double x : sample.weight) fine = fine && std::isfinite(x) && x >= 0;
        EXPECT_TRUE(fine) << name << " " << wi[0] << " " << wi[2] << " " << u;
      }
    }
  }
  FactorModel unbounded = AnalyticModel(ModelSpec::SharedFactors(1), 0.1, 0);
  for (double& s : unbounded.s(0)) s = 1e300;
  EXPECT_THAT(ErrorOf([&] { NdfSampler{unbounded}; }),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
