#include "trilobe/model/objective/parameter_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 5, .theta_d = 6, .phi_d = 8};

TEST(ParameterBlocks, HoldEachParameterOnce) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const FactorModel model = RandomModel(spec, 1);
    ParameterBlocks blocks(spec);
    blocks.Read(model);
    std::vector<int> seen;
    for (int b = 0; b < blocks.num_blocks(); ++b) {
      ASSERT_FALSE(blocks.block(b).empty()) << name;
      ASSERT_EQ(blocks.block(b).size(), blocks.parameters(b).size());
      for (size_t k = 0; k < blocks.block(b).size(); ++k) {
        seen.push_back(blocks.parameters(b)[k]);
        EXPECT_EQ(blocks.block(b)[k], model.parameters()[seen.back()]) << name;
      }
    }
    std::ranges::sort(seen);
    ASSERT_EQ(static_cast<int>(seen.size()), spec.num_parameters()) << name;
    for (int k = 0; k < spec.num_parameters(); ++k) EXPECT_EQ(seen[k], k) << name;

    FactorModel copy(spec);
    blocks.Write(&copy);
    EXPECT_TRUE(std::ranges::equal(copy.parameters(), model.parameters())) << name;
  }
}

TEST(ParameterBlocks, RowsAreOneEntryOfEveryTable) {
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const FactorModel model = RandomModel(spec, 2);
    ParameterBlocks blocks(spec);
    blocks.Read(model);
    EXPECT_TRUE(std::ranges::equal(blocks.block(ParameterBlocks::kD), model.d())) << name;
    for (int m = 0; m < spec.lobes; ++m) {
      EXPECT_TRUE(std::ranges::equal(
          blocks.block(ParameterBlocks::kS).subspan(kChannels * m, kChannels), model.s(m)))
          << name;
    }
    for (const Factor factor : kFactors) {
      for (int t = 0; t < spec.num_tables(factor); ++t) {
        for (int k = 0; k < spec.table_size(factor); ++k) {
          EXPECT_EQ(blocks.block(blocks.row(factor, k))[t], model.table(factor, t)[k])
              << name << ", " << FactorName(factor) << " " << t << " " << k;
        }
      }
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
