#include "model/lobes/lobe_match.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "model/lobes/gauge.h"
#include "model/lobes/lobes.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 10, .theta_d = 9, .phi_d = 15};

ModelFile RandomFile(uint64_t seed, const ModelSpec& spec = ModelSpec::SharedFactors(3, kGrid)) {
  ModelFile file{.model = FactorModel(spec), .unobserved = {}, .fit = {}};
  Random random(seed);
  for (double& x : file.model.parameters()) x = random.Uniform(0.1, 1);
  return file;
}

TEST(LobeMatch, IsOneForLobesThatDifferInScale) {
  const ModelFile a = RandomFile(1);
  ModelFile b = a;
  for (double& x : b.model.table(Factor::kD, 1)) x *= 1e180;
  for (double& x : b.model.table(Factor::kG, 1)) x *= 1e-200;
  for (double& x : b.model.s(1)) x *= 7;
  EXPECT_NEAR(LobeMatch(a, 1, b, 1), 1, 1e-14);
  EXPECT_LT(LobeMatch(a, 1, b, 0), 0.99);
}

TEST(LobeMatch, IsZeroForALobeThatIsBlack) {
  const ModelFile a = RandomFile(1);
  ModelFile b = a;
  std::ranges::fill(b.model.s(0), 0);
  EXPECT_EQ(LobeMatch(a, 0, b, 0), 0);
}

TEST(LobeMatch, WeighsDByProjectedSolidAngles) {
  // Two distributions that differ in one bin: the cosine of the angle between them, by hand.
  ModelFile a = RandomFile(1), b = a;
  std::ranges::fill(a.model.table(Factor::kD, 0), 1);
  std::ranges::fill(b.model.table(Factor::kD, 0), 1);
  b.model.table(Factor::kD, 0)[4] = 3;
  const std::vector<double> w = ProjectedAngles(a.model.spec().d_axis);
  const double sum = std::accumulate(w.begin(), w.end(), 0.0);
  const double both = sum + 2 * w[4], own = sum + 8 * w[4];
  EXPECT_NEAR(LobeMatch(a, 0, b, 0), both / std::sqrt(sum * own), 1e-14);
}

TEST(LobeMatch, LeavesOutWhatNoDataTouch) {
  const ModelFile a = RandomFile(1);
  ModelFile b = a;
  const int entry = b.model.TableOffset(Factor::kG, 2) + 7;
  b.model.parameters()[entry] = 1e6;
  EXPECT_LT(LobeMatch(a, 2, b, 2), 0.9);
  b.unobserved.assign(b.model.parameters().size(), false);
  b.unobserved[entry] = true;
  EXPECT_NEAR(LobeMatch(a, 2, b, 2), 1, 1e-14);
}

TEST(LobeMatch, ComparesFWhereLobesHaveTheirOwn) {
  ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  spec.F.per_lobe = true;
  const ModelFile a = RandomFile(1, spec);
  ModelFile b = a;
  for (int t = 0; t < spec.num_tables(Factor::kF); ++t) {
    if (spec.serves(Factor::kF, t, 0, 0)) b.model.table(Factor::kF, t)[3] = 100;
  }
  EXPECT_LT(LobeMatch(a, 0, b, 0), 0.9);
  EXPECT_NEAR(LobeMatch(a, 1, b, 1), 1, 1e-14);
}

TEST(LobeMatch, FindsTheOrder) {
  const ModelFile reference = RandomFile(2);
  ModelFile turned = reference;
  turned.model = WithLobes(reference.model, std::vector<int>{2, 0, 1});
  const LobeOrderMatch found = MatchLobes(reference, turned);
  EXPECT_EQ(found.lobe, (std::vector<int>{1, 2, 0}));
  EXPECT_NEAR(found.least(), 1, 1e-14);
  EXPECT_THROW(MatchLobes(reference, RandomFile(2, ModelSpec::SharedFactors(2, kGrid))), Error);
}

TEST(LobeMatch, OfModelsWithoutLobesIsOne) {
  const ModelFile file = RandomFile(1, ModelSpec::SharedFactors(0, kGrid));
  EXPECT_EQ(MatchLobes(file, file).least(), 1);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
