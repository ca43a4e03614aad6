#include "trilobe/model/table_layout.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 4};

TEST(TableLayout, TheFullOneStoresEverythingAndChangesNothing) {
  for (const NamedSpec& named : TestSpecs(kGrid)) {
    const TableLayout layout = TableLayout::Full(named.spec);
    const int exponents = named.name == "stretched highlights"          ? 2
                          : named.name == "lobes stretched differently" ? 6
                                                                        : 0;
    EXPECT_EQ(layout.num_parameters(named.spec), named.spec.num_parameters() + exponents)
        << named.name;
    EXPECT_EQ(layout.num_places(named.spec), 0);
    const FactorModel model = RandomModel(named.spec, 1);
    FactorModel expanded = model;
    ExpandStored(layout, &expanded);
    EXPECT_TRUE(std::ranges::equal(expanded.parameters(), model.parameters())) << named.name;
  }
}

TEST(TableLayout, IsLinearBetweenNodesAndConstantBeyond) {
  FactorModel model(ModelSpec::SharedFactors(1, kGrid));
  TableLayout layout = TableLayout::Full(model.spec());
  layout.of(Factor::kD, 0) = {1, 5};
  layout.of(Factor::kG, 0) = {2};
  layout.coloured_s = false;
  const auto D = model.table(Factor::kD, 0), G = model.table(Factor::kG, 0);
  D[1] = 4;
  D[5] = 0;
  G[2] = 7;
  model.s(0)[0] = 5;
  ExpandStored(layout, &model);
  EXPECT_EQ(std::vector<double>(D.begin(), D.end()), (std::vector<double>{4, 4, 3, 2, 1, 0}));
  for (const double g : G) EXPECT_EQ(g, 7);
  EXPECT_EQ(model.s(0)[2], 5);
  const int dropped = (6 - 2) + (model.spec().g_axis.size - 1) + 2;
  EXPECT_EQ(layout.num_parameters(model.spec()), model.spec().num_parameters() - dropped);
  EXPECT_EQ(layout.num_places(model.spec()), 3);
}

TEST(TableLayout, RefusesNodesThatAreNone) {
  const ModelSpec spec = ModelSpec::SharedFactors(1, kGrid);
  for (const std::vector<int>& nodes : {std::vector<int>{}, {2, 1}, {1, 1}, {-1, 2}, {0, 6}}) {
    TableLayout layout = TableLayout::Full(spec);
    layout.of(Factor::kD, 0) = nodes;
    EXPECT_THAT(ErrorOf([&] { CheckLayout(layout, spec); }),
                IsError(ErrorKind::kRange, {.key = "D"}));
  }
  EXPECT_THAT(
      ErrorOf([&] { CheckLayout(TableLayout::Full(ModelSpec::SharedFactors(2, kGrid)), spec); }),
      IsError(ErrorKind::kMismatch, {.key = "D", .value = "2"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
