#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "solvers/joint/log_stepper.h"
#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 8, .theta_d = 8, .phi_d = 16};

std::vector<double> Everything(const ModelSpec& spec) {
  return std::vector<double>(spec.num_parameters(), 1.0);
}

// One table of a factor is this function of its axis in [0, 1]; the others are 1 everywhere.
template <typename Function>
std::vector<double> Logarithms(const ModelSpec& spec, Factor factor, const Function& function) {
  const FactorModel model(spec);
  std::vector<double> y(spec.num_parameters(), 0.0);
  for (int k = 0; k < spec.table_size(factor); ++k) {
    const double t = spec.axis(factor).Theta(k) / (kPi / 2);
    y[model.TableOffset(factor, 0) + k] = function(factor == Factor::kD ? std::sqrt(t) : t);
  }
  return y;
}

TEST(Roughness, OfPowersOfTheAxisIsNothing) {
  for (const ModelSpec& spec : {ModelSpec::SharedFactors(2, kGrid), ModelSpec::IndependentG(kGrid),
                                ModelSpec::AnisotropicFor(2, 48, 1.3)}) {
    const Roughness roughness(spec, Everything(spec));
    for (const Factor factor : kFactors) {
      const auto steady = [](double t) { return 3 - 5 * t; };
      EXPECT_NEAR(roughness(Logarithms(spec, factor, steady)), 0, 1e-20) << FactorName(factor);
      const auto curved = [](double t) { return t * t; };
      EXPECT_GT(roughness(Logarithms(spec, factor, curved)), 1e-7) << FactorName(factor);
    }
  }
}

// On the paper's grid it is the sum of squared differences, and on any other the same integral.
TEST(Roughness, DoesNotDependOnTheNodes) {
  const auto wave = [](double t) { return std::cos(4 * t); };
  const auto roughness_on = [&](int size, Factor factor) {
    const ModelSpec spec =
        ModelSpec::SharedFactors(1, {.theta_h = size, .theta_d = size, .phi_d = 2 * size});
    return Roughness(spec, Everything(spec))(Logarithms(spec, factor, wave));
  };
  for (const Factor factor : kFactors) {
    const ModelSpec spec = ModelSpec::SharedFactors(1);
    const std::vector<double> y = Logarithms(spec, factor, wave);
    const int first = FactorModel(spec).TableOffset(factor, 0);
    double sum = 0;
    for (int k = first + 1; k < first + spec.table_size(factor) - 1; ++k) {
      sum += std::pow(y[k - 1] - 2 * y[k] + y[k + 1], 2);
    }
    EXPECT_NEAR(roughness_on(90, factor), sum, 1e-6 * sum) << FactorName(factor);
    EXPECT_NEAR(roughness_on(30, factor), sum, 0.1 * sum) << FactorName(factor);
  }
}

TEST(Roughness, ReachesAcrossEntriesWithoutData) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  std::vector<double> coverage = Everything(spec);
  const int F = FactorModel(spec).TableOffset(Factor::kF, 0);
  coverage[F + 3] = 0;
  const Roughness roughness(spec, coverage);
  std::vector<double> y = Logarithms(spec, Factor::kF, [](double t) { return 2 * t; });
  y[F + 3] = 17;
  EXPECT_NEAR(roughness(y), 0, 1e-20);
  y[F + 4] += 1;
  EXPECT_GT(roughness(y), 0);
}

// On the paper's grid the price of a fall is the sum of squared first differences.
TEST(Roughness, MayPriceASteadyFall) {
  for (const Factor factor : kFactors) {
    const ModelSpec spec = ModelSpec::SharedFactors(1);
    const std::vector<double> y = Logarithms(spec, factor, [](double t) { return 3 - 5 * t; });
    const int first = FactorModel(spec).TableOffset(factor, 0);
    double sum = 0;
    for (int k = first; k + 1 < first + spec.table_size(factor); ++k) {
      sum += std::pow(y[k + 1] - y[k], 2);
    }
    EXPECT_NEAR(Roughness(spec, Everything(spec), 0.1)(y), 0.1 * sum, 1e-6 * sum)
        << FactorName(factor);
  }
  const ModelSpec polar = ModelSpec::AnisotropicFor(1, 16, 1.3);
  std::vector<double> y(polar.num_parameters(), 2.0);
  EXPECT_NEAR(Roughness(polar, Everything(polar), 0.1)(y), 0, 1e-20);
  y[FactorModel(polar).TableOffset(Factor::kD, 0)] = 3;  // also around the azimuths
  EXPECT_GT(Roughness(polar, Everything(polar), 0.1)(y),
            Roughness(polar, Everything(polar))(y) * (1 + 1e-6));
}

TEST(Roughness, InterpolatesWhereItIsLeast) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  const int F = FactorModel(spec).TableOffset(Factor::kF, 0), end = F + spec.table_size(Factor::kF);
  const std::vector<double> line = Logarithms(spec, Factor::kF, [](double t) { return 3 - 5 * t; });
  std::vector<double> y = line;
  const std::vector<int> holes = {F + 2, F + 3, end - 1};
  for (const int k : holes) y[k] = -14;
  const auto whole = Roughness(spec, Everything(spec)).Interpolated(holes, y);
  ASSERT_TRUE(whole);
  for (size_t k = 0; k < holes.size(); ++k) EXPECT_NEAR((*whole)[k], line[holes[k]], 1e-9);

  // With a price of falls, no other values have less.
  const Roughness roughness(spec, Everything(spec), 0.1);
  const auto level = roughness.Interpolated(holes, y);
  ASSERT_TRUE(level);
  for (size_t k = 0; k < holes.size(); ++k) y[holes[k]] = (*level)[k];
  const double least = roughness(y);
  for (const int k : holes) {
    for (const double move : {-1e-3, 1e-3}) {
      y[k] += move;
      EXPECT_GT(roughness(y), least);
      y[k] -= move;
    }
  }

  std::vector<int> all(spec.table_size(Factor::kF));
  std::iota(all.begin(), all.end(), F);
  EXPECT_FALSE(Roughness(spec, Everything(spec)).Interpolated(all, y)) << "nothing holds them";
}

// E + f R to second order, of which R is all.
TEST(Roughness, HasTheDerivativesThatItSays) {
  for (const ModelSpec& spec :
       {ModelSpec::SharedFactors(2, kGrid), ModelSpec::AnisotropicFor(1, 16, 1.3)}) {
    const Roughness roughness(spec, Everything(spec));
    const size_t n = spec.num_parameters();
    Random random(1);
    std::vector<double> y(n), step(n), there(n);
    for (size_t k = 0; k < n; ++k) {
      y[k] = random.Normal();
      step[k] = random.Normal();
      there[k] = y[k] + step[k];
    }
    QuadraticModel at;
    at.gradient.assign(n, 0);
    at.H.assign(n * n, 0);
    constexpr double kFactor = 3;
    roughness.AddTo(kFactor, y, &at);
    double change = 0;
    for (size_t k = 0; k < n; ++k) {
      change += 2 * at.gradient[k] * step[k];
      for (size_t l = 0; l < n; ++l) change += step[k] * at.H[k * n + l] * step[l];
    }
    EXPECT_NEAR(at.objective, kFactor * roughness(y), 1e-12 * at.objective);
    EXPECT_NEAR(at.objective + change, kFactor * roughness(there), 1e-12 * at.objective);
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
