#include "trilobe/model/bsdf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/system/process.h"
#include "tests/error_of.h"
#include "tests/model/half_vector_bins.h"
#include "tests/model/materials.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/load_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr double kThetaI[] = {0, 15, 30, 45, 60, 75, 85, 89};  // [degrees]

Direction WiAt(double degrees) { return DirectionAt(DegreesToRadians(degrees), 0.4); }

struct Drawn {
  std::vector<int> counts = std::vector<int>(HalfVectorBins::kCount);
  int lost = 0;
  double largest_weight = 0;
  Rgb sum{}, squares{};
};

Drawn Draw(const Bsdf<double>& bsdf, const Direction& wi, int n, uint64_t seed) {
  Random random(seed);
  Drawn drawn;
  for (int k = 0; k < n; ++k) {
    const auto sample = bsdf.SampleWo(wi, {random.Uniform(), random.Uniform()});
    if (!(sample.pdf > 0)) {
      ++drawn.lost;
      continue;
    }
    EXPECT_NEAR(bsdf.Pdf(wi, sample.wo), sample.pdf, 1e-6 * sample.pdf);
    ++drawn.counts[HalfVectorBins::Of(wi, sample.wo)];
    for (int c = 0; c < kChannels; ++c) {
      drawn.largest_weight = std::max(drawn.largest_weight, sample.weight[c]);
      drawn.sum[c] += sample.weight[c];
      drawn.squares[c] += sample.weight[c] * sample.weight[c];
    }
  }
  return drawn;
}

TEST(BsdfSampling, DrawsWithItsDensity) {
  constexpr int kDraws = kSanitized ? 4000 : 20000;
  for (const auto& [name, model] : TestMaterials()) {
    const Bsdf<double> bsdf(model);
    for (const double degrees : kThetaI) {
      const Direction wi = WiAt(degrees);
      const std::string where = name + ", theta_i = " + std::to_string(degrees);
      const Drawn drawn = Draw(bsdf, wi, kDraws, 3);
      EXPECT_LE(drawn.lost, 0.01 * kDraws) << where;
      std::vector<double> expected(HalfVectorBins::kCount);
      double total = 0;
      for (int bin = 0; bin < HalfVectorBins::kCount; ++bin) {
        expected[bin] = kDraws * HalfVectorBins::Integral(wi, bin, [&](const Direction& wo) {
                          return bsdf.Pdf(wi, wo);
                        });
        total += expected[bin];
      }
      EXPECT_NEAR(total / kDraws, 1, 0.02) << where;
      for (double& x : expected) x *= kDraws / total;  // the integral's own error
      EXPECT_LT(ChiSquared(drawn.counts, expected), 5) << where;
    }
  }
}

TEST(BsdfSampling, WeightsAreBoundedAndAddUpToTheAlbedo) {
  constexpr int kDraws = kSanitized ? 2000 : 10000;
  for (const auto& [name, model] : TestMaterials()) {
    // Left out: a model whose neighbouring entries are unrelated, and one whose lobe is narrower by
    // 1 / cos^2 theta_d, which has more detail towards grazing than the table.
    if (name == "random numbers" || name == "stretched to the limits") continue;
    const Bsdf<double> bsdf(model);
    for (const double degrees : kThetaI) {
      const Direction wi = WiAt(degrees);
      const std::string where = name + ", theta_i = " + std::to_string(degrees);
      const Drawn drawn = Draw(bsdf, wi, kDraws, 4);
      const Rgb albedo = bsdf.Albedo(wi);
      EXPECT_LE(degrees <= 85 ? drawn.largest_weight : 0, 4) << where;
      for (int c = 0; c < kChannels; ++c) {
        const double mean = drawn.sum[c] / kDraws;
        const double variance = std::max(drawn.squares[c] / kDraws - mean * mean, 0.0);
        // Standard errors of the sampling, and the error of the table of albedos.
        const double of_table = degrees <= 75 ? 0.015 : degrees <= 85 ? 0.03 : 0.2;
        EXPECT_NEAR(albedo[c], mean, 5 * std::sqrt(variance / kDraws) + of_table * mean + 1e-9)
            << where;
      }
    }
  }
}

// F and G of fits differ by decades from one entry to the next, and near grazing a stretched
// highlight is a ridge along theta_o = theta_i, narrower than the table's cells.
TEST(BsdfSampling, WeightsOfBundledMaterialsAreBounded) {
  constexpr int kDraws = kSanitized ? 100 : 1000;
  int number = 0;
  for (const std::string_view name : MaterialNames()) {
    if (!IsOneIn(4, {number++})) continue;
    const Bsdf<double> bsdf(LoadModel(std::string(kMaterialPrefix).append(name)).model);
    for (double degrees = 0.25; degrees < 85; degrees += 0.5) {
      EXPECT_LE(Draw(bsdf, WiAt(degrees), kDraws, 9).largest_weight, 4)
          << name << ", theta_i = " << degrees;
    }
  }
}

// Fits of measured materials may have such a G: neighbouring entries differ by a factor of five.
TEST(BsdfSampling, AlbedoFollowsEachEntryOfG) {
  FactorModel model = AnalyticModel(ModelSpec::SharedFactors(2), 0.2, 0.05);
  for (int t = 0; t < model.spec().num_tables(Factor::kG); ++t) {
    const std::span<double> G = model.table(Factor::kG, t);
    for (size_t k = 0; k < G.size(); ++k) G[k] *= k % 2 == 0 ? 1 : 0.2;
  }
  const Bsdf<double> bsdf(model);
  constexpr int kSteps = 300;  // in each random number
  for (const double degrees : {0.0, 14.0, 33.5, 50.2, 71.0, 75.0}) {
    const Direction wi = WiAt(degrees);
    double mean = 0;
    for (int a = 0; a < kSteps; ++a) {
      for (int b = 0; b < kSteps; ++b) {
        const auto drawn = bsdf.SampleWo(wi, {(a + 0.5) / kSteps, (b + 0.5) / kSteps});
        mean += drawn.weight[1] / (kSteps * kSteps);
      }
    }
    EXPECT_NEAR(bsdf.Albedo(wi)[1], mean, 0.01 * mean) << degrees;
  }
}

// Near the horizon, where sampling by D loses one of five.
TEST(BsdfSampling, HardlyDrawsBelowTheHorizon) {
  const Bsdf<double> bsdf(AnalyticModel(ModelSpec::SharedFactors(3), 0.3, 0));
  EXPECT_LE(Draw(bsdf, WiAt(85), 10000, 5).lost, 10);
}

TEST(BsdfSampling, MovesContinuouslyWithItsNumbers) {
  for (const auto& [name, model] : TestMaterials()) {
    const Bsdf<double> bsdf(model);
    const Direction wi = WiAt(50);
    constexpr double kStep = 1e-7;
    int jumps = 0;
    Random random(6);
    for (int k = 0; k < 500; ++k) {
      const double u = random.Uniform(0, 1 - kStep), v = random.Uniform(0, 1 - kStep);
      const auto from = bsdf.SampleWo(wi, {u, v}),
                 sampled = bsdf.SampleWo(wi, {u + kStep, v + kStep});
      const double distance = std::hypot(sampled.wo[0] - from.wo[0], sampled.wo[1] - from.wo[1]);
      jumps += distance > 0.05;
    }
    EXPECT_LE(jumps, 1) << name;  // from one component to the other
  }
}

TEST(BsdfSampling, ManyAtOnceAreThoseOfEach) {
  for (const auto& [name, model] : TestMaterials()) {
    const Bsdf<double> bsdf(model);
    Random random(8);
    std::vector<Direction> wi(20), wo(20);
    std::vector<std::array<double, 2>> u(20);
    for (size_t k = 0; k < wi.size(); ++k) {
      wi[k] = DirectionAt(random.Uniform(0, 1.6), random.Uniform(-kPi, kPi));
      wo[k] = DirectionAt(random.Uniform(0, 1.6), random.Uniform(-kPi, kPi));
      u[k] = {random.Uniform(), random.Uniform()};
    }
    std::vector<Bsdf<double>::Sample> samples(20);
    std::vector<double> pdfs(20);
    bsdf.SamplesOfWo(wi, u, samples);
    bsdf.Pdfs(wi, wo, pdfs);
    for (size_t k = 0; k < wi.size(); ++k) {
      EXPECT_EQ(samples[k].wo, bsdf.SampleWo(wi[k], u[k]).wo) << name;
      EXPECT_EQ(samples[k].weight, bsdf.SampleWo(wi[k], u[k]).weight) << name;
      EXPECT_EQ(pdfs[k], bsdf.Pdf(wi[k], wo[k])) << name;
    }
    pdfs.pop_back();
    EXPECT_THAT(ErrorOf([&] { bsdf.Pdfs(wi, wo, pdfs); }),
                IsError(ErrorKind::kMismatch, {.key = "wi", .value = "20"}));
    u.pop_back();
    EXPECT_THAT(ErrorOf([&] { bsdf.SamplesOfWo(wi, u, samples); }),
                IsError(ErrorKind::kMismatch, {.key = "wi", .value = "20"}));
  }
}

TEST(BsdfSampling, HasAnAnswerForAnyNumbersAndDirections) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  std::vector<NamedModel> models = TestMaterials();
  models.push_back({"black", FactorModel(ModelSpec::SharedFactors(2))});
  FactorModel dark = AnalyticModel(ModelSpec::SharedFactors(2), 0.1, 0.3);
  for (double& s : dark.s(0)) s = 0;
  models.push_back({"a lobe of nothing", dark});
  FactorModel one = AnalyticModel(ModelSpec::SharedFactors(1), 0.1, 0);
  for (double& x : one.table(Factor::kD, 0)) x = 0;
  one.table(Factor::kD, 0)[7] = 1;
  models.push_back({"one bin", one});
  const double numbers[] = {0, 1, -1, 2, 0.5, nan, infinity};
  const Direction directions[] = {{0, 0, 1},        {0.6, 0, 0.8},   {1, 0, 1e-9}, {0, 0, 0},
                                  {0.6, 0, -0.8},   {nan, 0, 1},     {0, 0, nan},  {3, 4, 5},
                                  {0, 0, infinity}, {infinity, 0, 1}};
  for (const NamedModel& named : models) {
    const std::string& name = named.name;
    const Bsdf<double> bsdf(named.model);
    const Bsdf<float> rounded(named.model);
    const bool with_albedo = named.name == "one bin" || IsOneIn(4, {NumberOf(named, models)});
    for (const Direction& wi : directions) {
      for (const double x : with_albedo ? bsdf.Albedo(wi) : Rgb{})
        EXPECT_TRUE(std::isfinite(x) && x >= 0) << name;
      for (const double u : numbers) {
        for (const double v : numbers) {
          const auto check = [&](const auto& sample) {
            bool fine = std::isfinite(sample.pdf) && sample.pdf >= 0;
            for (const auto x : sample.weight) fine = fine && std::isfinite(x) && x >= 0;
            for (const auto x : sample.wo) fine = fine && std::isfinite(x);
            EXPECT_TRUE(fine) << name << " " << wi[0] << " " << wi[2] << " " << u << " " << v;
          };
          check(bsdf.SampleWo(wi, {u, v}));
          check(rounded.SampleWo(
              {static_cast<float>(wi[0]), static_cast<float>(wi[1]), static_cast<float>(wi[2])},
              {static_cast<float>(u), static_cast<float>(v)}));
        }
      }
      for (const Direction& wo : directions) {
        const double pdf = bsdf.Pdf(wi, wo);
        EXPECT_TRUE(std::isfinite(pdf) && pdf >= 0) << name;
      }
    }
    EXPECT_EQ(bsdf.SampleWo({0.6, 0, -0.8}, {0.5, 0.5}).pdf, 0);
    EXPECT_EQ(bsdf.Pdf({0, 0, 1}, {0.6, 0, -0.8}), 0);
  }
}

TEST(BsdfTest, FloatAgreesWithDouble) {
  int number = 0;
  for (const auto& [name, model] : TestMaterials()) {
    const bool with_albedo = IsOneIn(4, {number++});  // which takes most of the time
    const Bsdf<double> bsdf(model);
    const Bsdf<float> rounded(model);
    Random random(7);
    for (int k = 0; k < 100; ++k) {
      const Direction wi = DirectionAt(random.Uniform(0, 1.4), random.Uniform(-kPi, kPi));
      const Direction wo = DirectionAt(random.Uniform(0, 1.4), random.Uniform(-kPi, kPi));
      const auto in_float = [](const Direction& w) {
        return std::array<float, 3>{static_cast<float>(w[0]), static_cast<float>(w[1]),
                                    static_cast<float>(w[2])};
      };
      const double pdf = bsdf.Pdf(wi, wo);
      EXPECT_NEAR(rounded.Pdf(in_float(wi), in_float(wo)), pdf, 0.01 * pdf) << name;
      if (!with_albedo) continue;
      EXPECT_NEAR(rounded.Albedo(in_float(wi))[1], bsdf.Albedo(wi)[1], 1e-3) << name;
    }
  }
}

// A table of sampling takes as long as some hundred thousand values.
TEST(BsdfTest, ValuesNeedNoTableOfSampling) {
  const FactorModel model = AnalyticModel(ModelSpec::SharedFactors(3), 0.1, 0.5);
  const auto seconds = [](const auto& what) {
    const double begin = ProcessorSeconds();
    what();
    return ProcessorSeconds() - begin;
  };
  std::optional<Bsdf<double>> bsdf;
  const double values = seconds([&] {
    bsdf.emplace(model);
    EXPECT_GT(bsdf->Value({0, 0, 1}, {0.6, 0, 0.8})[0], 0);
  });
  const double first = seconds([&] { EXPECT_GT(bsdf->Pdf({0, 0, 1}, {0.6, 0, 0.8}), 0); });
  const double second = seconds([&] { EXPECT_GT(bsdf->Pdf({0, 0, 1}, {0.6, 0, 0.8}), 0); });
  EXPECT_LT(values, first / 4);
  EXPECT_LT(second, first / 4);
}

TEST(BsdfTest, RefusesAModelWhoseValuesOverflow) {
  FactorModel model = AnalyticModel(ModelSpec::SharedFactors(1), 0.1, 0);
  for (double& s : model.s(0)) s = 1e300;
  EXPECT_THAT(ErrorOf([&] { Bsdf<double>{model}; }),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
  EXPECT_THAT(ErrorOf([&] { Bsdf<float>{model}; }),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
  for (double& s : model.s(0)) s = 1;
  for (double& d : model.d()) d = 1e39;
  EXPECT_THAT(ErrorOf([&] { Bsdf<float>{model}; }),
              IsError(ErrorKind::kData, {.key = "model", .value = "overflow"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
