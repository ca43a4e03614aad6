// Invalid arguments to finishing steps or to the prior give an Error of one line, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "fit/finish/data_edge.h"
#include "fit/finish/reflectance.h"
#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/fit/finish/node_choice.h"
#include "trilobe/fit/finish/synthetic_prior.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// One that is asked whether to stop says no.
TEST(FitArguments, EmptyFunctions) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  FactorModel model = RandomModel(spec, 1);
  EXPECT_FALSE(TieEntriesAtDataEdge(objective, &model, nullptr));
  EXPECT_NO_THROW(MatchReflectance(objective, objective, model, TableLayout::Full(spec), 30, {}));
}

TEST(FitArguments, NumbersOutOfTheirRange) {
  const ModelSpec spec = ModelSpec::SharedFactors(2, kGrid);
  const Objective objective = MakeObjective(RandomTable(kGrid, 1), spec);
  for (const double bad : {0.0, -1.0, kNaN, kInfinity}) {
    EXPECT_THAT(ErrorOf([&] { WithPrior(objective, {.weight = bad}); }),
                IsError(ErrorKind::kRange, {.key = "weight"}));
  }
  for (const double bad : {-1.0, kNaN, kInfinity}) {
    EXPECT_THAT(ErrorOf([&] {
                  ChooseNodes(objective, {FormSpec{.name = "own", .spec = spec}}, {.prior = bad});
                }),
                IsError(ErrorKind::kRange, {.key = "prior"}));
  }
}

TEST(FitArguments, ModelsOfAnotherSpec) {
  const Objective objective =
      MakeObjective(RandomTable(kGrid, 1), ModelSpec::SharedFactors(2, kGrid));
  FactorModel other(ModelSpec::SharedFactors(1, kGrid));
  EXPECT_THAT(ErrorOf([&] { TieEntriesAtDataEdge(objective, &other); }),
              IsError(ErrorKind::kMismatch, {.key = "spec"}));
  FactorModel bad(objective.spec());
  bad.d()[1] = kNaN;
  EXPECT_THAT(ErrorOf([&] { TieEntriesAtDataEdge(objective, &bad); }),
              IsError(ErrorKind::kData, {.key = "parameter 1", .value = "nan"}));
  EXPECT_THAT(ErrorOf([&] { ReflectanceOf(objective, other); }),
              IsError(ErrorKind::kMismatch, {.key = "spec"}));
  const TableLayout layout = TableLayout::Full(other.spec());
  EXPECT_THAT(ErrorOf([&] { MatchReflectance(objective, objective, other, layout, 30); }),
              IsError(ErrorKind::kMismatch, {.key = "spec"}));
  EXPECT_THAT(ErrorOf([&] { MatchReflectance(objective, objective, bad, layout, 30); }),
              IsError(ErrorKind::kData, {.key = "parameter 1", .value = "nan"}));
  bad.d()[1] = 1;
  EXPECT_THAT(ErrorOf([&] {
                MatchReflectance(objective, Objective(objective, other.spec()), bad, layout, 30);
              }),
              IsError(ErrorKind::kMismatch, {.key = "spec"}));
  EXPECT_THAT(ErrorOf([&] { MatchReflectance(objective, objective, bad, layout, 30); }),
              IsError(ErrorKind::kMismatch, {.key = "D", .value = "1"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
