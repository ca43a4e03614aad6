#include "model/objective/lobe_match.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "model/objective/gauge.h"
#include "model/objective/lobes.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/objective/lobe_light.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 10, .theta_d = 9, .phi_d = 15};
constexpr Rgb kWhite{1, 1, 1};

ModelFile RandomFile(uint64_t seed, const ModelSpec& spec = ModelSpec::SharedFactors(3, kGrid)) {
  ModelFile file{.model = FactorModel(spec), .unobserved = {}, .fit = {}};
  Random random(seed);
  for (double& x : file.model.parameters()) x = random.Uniform(0.1, 1);
  return file;
}

void Scale(std::span<double> values, double factor) {
  for (double& x : values) x *= factor;
}

std::vector<Rgb> LightOf(const ModelFile& file) {
  const std::vector<double> everywhere(file.model.parameters().size(), 1);
  return ComputeLobeLight(everywhere, file.model).lobes;
}

double Sum(const Rgb& rgb) { return rgb[0] + rgb[1] + rgb[2]; }

double Total(const std::vector<Rgb>& lobes) {
  return std::accumulate(lobes.begin(), lobes.end(), 0.0,
                         [](double sum, const Rgb& rgb) { return sum + Sum(rgb); });
}

TEST(LobeMatch, DependsOnNeitherGaugeNorOrder) {
  const ModelFile a = RandomFile(1), b = RandomFile(2);
  ModelFile moved = b;
  FactorModel& model = moved.model;
  Scale(model.table(Factor::kD, 1), 1e100);
  Scale(model.s(1), 1e-100);
  Scale(model.table(Factor::kG, 2), 1e-3);
  Scale(model.s(2), 1e6);
  Scale(model.table(Factor::kF, 2), 7);
  for (int m = 0; m < 3; ++m) model.s(m)[2] /= 7;
  moved.model = WithLobes(model, std::vector<int>{2, 0, 1});
  const LobeMatch match = MatchLobes(a, b), of_moved = MatchLobes(a, moved);
  EXPECT_LT(match.agreement, 0.9);
  EXPECT_NEAR(of_moved.agreement, match.agreement, 1e-12);
  for (int m = 0; m < 3; ++m) {
    EXPECT_NEAR(of_moved.match[m], match.match[m], 1e-12);
    EXPECT_EQ(of_moved.lobe[m], (match.lobe[m] + 1) % 3);
  }
  EXPECT_NEAR(MatchLobes(b, moved).agreement, 1, 1e-12);
  EXPECT_NEAR(MatchLobes(b, a).agreement, match.agreement, 1e-12);
}

TEST(LobeMatch, FallsWithTheStrengthOfLobes) {
  ModelFile a = RandomFile(1);
  for (int m = 0; m < 3; ++m) {  // lobes that nobody takes for one another
    const std::span<double> D = a.model.table(Factor::kD, m);
    for (size_t k = 0; k < D.size(); ++k) D[k] = k / 4 == static_cast<size_t>(m) ? 1 : 0;
  }
  ModelFile b = a;
  Scale(b.model.s(0), 5);
  Scale(b.model.s(1), 0.05);
  const LobeMatch match = MatchLobes(a, b);
  EXPECT_EQ(match.lobe, (std::vector<int>{0, 1, 2}));
  EXPECT_NEAR(match.match[0], 0.2, 1e-12);
  EXPECT_NEAR(match.match[1], 0.05, 1e-12);
  EXPECT_NEAR(match.match[2], 1, 1e-12);
  const std::vector<Rgb> light = LightOf(a), of_b = LightOf(b);
  double sum = 0;
  for (int m = 0; m < 3; ++m) sum += match.match[m] * (Sum(light[m]) + Sum(of_b[m]));
  EXPECT_NEAR(match.agreement, sum / (Total(light) + Total(of_b)), 1e-12);
  EXPECT_LT(match.agreement, 0.5);
}

TEST(LobeMatch, OfAColourIsWhatIsSharedInEachChannel) {
  const ModelFile a = RandomFile(1);
  ModelFile b = a;
  b.model.s(1)[0] *= 2;
  const Rgb light = LightOf(a)[1];
  EXPECT_NEAR(MatchLobes(a, b).match[1], Sum(light) / (Sum(light) + light[0]), 1e-12);
}

TEST(LobeMatch, CountsALobeByItsLight) {
  ModelFile a = RandomFile(1);
  Scale(a.model.s(2), 0.02);
  ModelFile b = a;
  std::ranges::reverse(b.model.table(Factor::kD, 2));
  const std::vector<Rgb> light = LightOf(a);
  const double share = Sum(light[2]) / Total(light);
  EXPECT_LT(share, 0.02);
  const LobeMatch match = MatchLobes(a, b);
  EXPECT_LT(match.match[2], 0.8);
  EXPECT_GT(match.agreement, 1 - 2 * share);
  EXPECT_LT(match.agreement, 1);
}

TEST(LobeMatch, OfAPairWithoutLightCountsNothing) {
  const ModelFile a = RandomFile(1);
  ModelFile b = a;
  std::ranges::fill(b.model.s(0), 0);
  const LobeMatch match = MatchLobes(a, b);
  EXPECT_EQ(match.match[0], 0);
  const std::vector<Rgb> light = LightOf(a);
  const double rest = Total(light) - Sum(light[0]);
  EXPECT_NEAR(match.agreement, 2 * rest / (2 * rest + Sum(light[0])), 1e-12);
  EXPECT_NEAR(MatchLobes(b, b).agreement, 1, 1e-14);
  for (int m = 0; m < 3; ++m) std::ranges::fill(b.model.s(m), 0);
  EXPECT_EQ(MatchLobes(b, b).agreement, 1);
  EXPECT_EQ(MatchLobes(a, b).agreement, 0);
}

TEST(LobeMatch, OfMoreLobesAgreesByThoseThatHavePartners) {
  const ModelFile three = RandomFile(1);
  ModelFile two = three;
  two.model = WithoutLobe(three.model, 1);
  const std::vector<Rgb> light = LightOf(three);
  const double missing = Sum(light[1]), all = Total(light);
  const double agreement = 2 * (all - missing) / (2 * all - missing);
  const LobeMatch of_two = MatchLobes(three, two), of_three = MatchLobes(two, three);
  EXPECT_EQ(of_two.lobe, (std::vector<int>{0, -1, 1}));
  EXPECT_EQ(of_two.match[1], 0);
  EXPECT_NEAR(of_two.agreement, agreement, 1e-12);
  EXPECT_EQ(of_three.lobe, (std::vector<int>{0, 2}));
  EXPECT_NEAR(of_three.agreement, agreement, 1e-12);
  const ModelFile none = RandomFile(1, ModelSpec::SharedFactors(0, kGrid));
  EXPECT_EQ(MatchLobes(none, none).agreement, 1);
  EXPECT_EQ(MatchLobes(three, none).agreement, 0);
}

// Two tables that differ in one entry: the cosine between them, by hand.
TEST(LobeMatch, WeighsEntriesByProjectedSolidAngles) {
  const auto ring = [](double from, double to) {
    return std::pow(std::sin(to), 2) - std::pow(std::sin(from), 2);
  };
  const auto root = [](int k) { return k * k / 100.0 * kPi / 2; };
  const auto even = [](int k) { return k / 9.0 * kPi / 2; };
  const double of_D = ring(root(4), root(5)), of_F = ring(even(4), even(5));
  for (const auto& [factor, weight] : {std::pair{Factor::kD, of_D}, {Factor::kF, of_F}}) {
    ModelFile a = RandomFile(1), b = a;
    for (int t = 0; t < 3; ++t) {
      std::ranges::fill(a.model.table(factor, t), 1);
      std::ranges::fill(b.model.table(factor, t), 1);
      b.model.table(factor, t)[4] = 3;
    }
    const double cosine = (1 + 2 * weight) / std::sqrt(1 + 8 * weight);
    EXPECT_NEAR(FactorCosine(factor, a, 0, b, 0, kWhite), cosine, 1e-14) << FactorName(factor);
  }
}

TEST(LobeMatch, WeighsTablesOfChannelsByTheirLight) {
  const ModelFile a = RandomFile(1);
  ModelFile b = a;
  std::ranges::reverse(b.model.table(Factor::kF, 2));
  const double of_blue = FactorCosine(Factor::kF, a, 0, b, 0, {0, 0, 3});
  EXPECT_LT(of_blue, 0.95);
  EXPECT_NEAR(FactorCosine(Factor::kF, a, 0, b, 0, {0.5, 0.25, 0.25}), 0.75 + 0.25 * of_blue,
              1e-14);
}

TEST(LobeMatch, LeavesOutWhatNoDataTouch) {
  const ModelFile a = RandomFile(1);
  ModelFile b = a;
  const int entry = b.model.TableOffset(Factor::kG, 2) + 7;
  b.model.parameters()[entry] = 1e6;
  EXPECT_LT(FactorCosine(Factor::kG, a, 2, b, 2, kWhite), 0.9);
  b.unobserved.assign(b.model.parameters().size(), false);
  b.unobserved[entry] = true;
  EXPECT_NEAR(FactorCosine(Factor::kG, a, 2, b, 2, kWhite), 1, 1e-14);
}

TEST(LobeMatch, ComparesFWhereLobesHaveTheirOwn) {
  ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  spec.F.per_lobe = true;
  const ModelFile a = RandomFile(1, spec);
  ModelFile b = a;
  for (int c = 0; c < kChannels; ++c)
    b.model.table(Factor::kF, spec.table(Factor::kF, 0, c))[3] = 9;
  const LobeMatch match = MatchLobes(a, b);
  EXPECT_LT(match.match[0], 0.9);
  EXPECT_NEAR(match.match[1], 1, 1e-14);
}

TEST(LobeMatch, ComparesAnisotropicLobes) {
  ModelSpec spec = ModelSpec::Anisotropic(2);
  const ModelFile a = RandomFile(1, spec);
  ModelFile b = a;
  EXPECT_NEAR(MatchLobes(a, b).agreement, 1, 1e-14);
  std::ranges::reverse(b.model.table(Factor::kD, 0));
  EXPECT_LT(MatchLobes(a, b).match[0], 0.95);
}

TEST(LobeMatch, IsOfModelsOfOneForm) {
  ModelSpec own_F = ModelSpec::SharedFactors(3, kGrid), finer = own_F, stretched = own_F;
  own_F.F.per_lobe = true;
  finer.g_axis.size = 12;
  stretched.stretches = Stretch{.along = 0.5, .across = 0};
  const ModelFile file = RandomFile(2);
  EXPECT_THAT(ErrorOf([&] { MatchLobes(file, RandomFile(2, own_F)); }),
              IsError(ErrorKind::kMismatch, {.key = "spec"}));
  EXPECT_THAT(ErrorOf([&] { MatchLobes(file, RandomFile(2, finer)); }),
              IsError(ErrorKind::kMismatch, {.key = "spec"}));
  EXPECT_EQ(MatchLobes(file, RandomFile(2, stretched)).agreement, 0);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
