// Invalid tables, grids and axes give an Error of one line, and no crash.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/error_of.h"
#include "tests/test_util.h"
#include "trilobe/model/measurement/measurement_stats.h"
#include "trilobe/model/measurement/tabulated_brdf.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 5, .phi_d = 8};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Arguments, TablesAndGrids) {
  BrdfTable table = RandomTable(kGrid, 1);
  table.stored[2].pop_back();
  EXPECT_THAT(ErrorOf([&] { ValidSamples(table); }),
              IsError(ErrorKind::kMismatch, {.key = "stored", .value = "239"}));
  EXPECT_THAT(ErrorOf([&] { CountBins(table); }),
              IsError(ErrorKind::kMismatch, {.key = "stored", .value = "239"}));
  EXPECT_THAT(ErrorOf([&] { TabulatedBrdf{table}; }),
              IsError(ErrorKind::kMismatch, {.key = "stored", .value = "239"}));
  EXPECT_THAT(ErrorOf([&] { LimitAngles(1, Unmeasured::kBeyondMaxAngle, &table); }),
              IsError(ErrorKind::kMismatch, {.key = "stored", .value = "239"}));
  table = RandomTable(kGrid, 1);
  table.unmeasured.resize(3);
  EXPECT_THAT(ErrorOf([&] { ValidBins(table); }),
              IsError(ErrorKind::kMismatch, {.key = "unmeasured", .value = "3"}));
  table.unmeasured.clear();
  for (const double bad : {kNaN, -1.0}) {
    EXPECT_THAT(ErrorOf([&] { LimitAngles(bad, Unmeasured::kBeyondMaxAngle, &table); }),
                IsError(ErrorKind::kRange, {.key = "max_theta"}));
  }
  EXPECT_THAT(ErrorOf([&] { LimitThetaD(kNaN, &table); }),
              IsError(ErrorKind::kRange, {.key = "min_theta_d", .value = "nan"}));
  for (const MerlGrid& bad : {MerlGrid{.theta_h = 0}, MerlGrid{.theta_d = -1},
                              MerlGrid{.theta_h = 1 << 20, .theta_d = 1 << 20}}) {
    EXPECT_THAT(ErrorOf([&] { MakeInvalidTable("bad", bad); }),
                IsError(ErrorKind::kRange, {.key = "grid of bins"}));
    EXPECT_THAT(ErrorOf([&] { BinsAboveSurface(bad); }),
                IsError(ErrorKind::kRange, {.key = "grid of bins"}));
    EXPECT_THAT(ErrorOf([&] { Reconstruct(FactorModel(), "bad", bad); }),
                IsError(ErrorKind::kRange, {.key = "grid of bins"}));
  }
  EXPECT_THAT(ErrorOf([] { VisibleSolidAngles(0); }),
              IsError(ErrorKind::kRange, {.key = "grid of bins"}));
}

TEST(Arguments, AxesAndTheirEntries) {
  for (const int phi : {0, -1, 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] {
                  Axis::Polar({0, 10}, phi);
                }),
                IsError(ErrorKind::kRange, {.key = "axis"}));
  }
  EXPECT_THAT(ErrorOf([] { Axis::Polar({}, 1); }), IsError(ErrorKind::kRange, {.key = "axis"}));
  EXPECT_THAT(ErrorOf([] { Axis::Polar(std::vector<double>(1 << 20), 1 << 20); }),
              IsError(ErrorKind::kRange, {.key = "axis"}));
  for (const int thetas : {0, -1, 1 << 30}) {
    EXPECT_THAT(ErrorOf([&] { Axis::EvenPolar(thetas, Axis::Steps::kOfTheta, 4); }),
                IsError(ErrorKind::kRange, {.key = "the number of theta of an axis"}));
  }
  // Members say what they like.
  const Axis no_nodes = {.rule = Axis::Rule::kPolar, .size = 4, .theta = {}, .phi_nodes = 0};
  EXPECT_THAT(ErrorOf([&] { no_nodes.At(0, 0); }),
              IsError(ErrorKind::kMismatch, {.key = "axis", .value = "4"}));
  EXPECT_FALSE(no_nodes.reaches_horizon());
  for (const auto rule : {Axis::Rule::kRootTheta, Axis::Rule::kTheta, Axis::Rule::kSpline}) {
    EXPECT_THAT(ErrorOf([&] { Axis{.rule = rule, .size = 0}.At(0, 0); }),
                IsError(ErrorKind::kRange, {.value = "0"}));
  }
  for (const Axis& axis : {Axis::Utia(), Axis{.rule = Axis::Rule::kTheta, .size = 5}}) {
    for (const int entry : {-1, axis.size, 1 << 30}) {
      EXPECT_THAT(ErrorOf([&] { axis.Theta(entry); }),
                  IsError(ErrorKind::kRange, {.key = "the entry of a table"}));
      EXPECT_THAT(ErrorOf([&] { axis.Phi(entry); }),
                  IsError(ErrorKind::kRange, {.key = "the entry of a table"}));
      EXPECT_THAT(ErrorOf([&] { axis.CellOf(entry); }),
                  IsError(ErrorKind::kRange, {.key = "the entry of a table"}));
    }
  }
  EXPECT_THAT(ErrorOf([] { OnCircle(kNaN, 4); }),
              IsError(ErrorKind::kRange, {.key = "radians", .value = "nan"}));
  EXPECT_THAT(
      ErrorOf([] { OnCircle(1, 0); }),
      IsError(ErrorKind::kRange, {.key = "the number of steps around a circle", .value = "0"}));
  EXPECT_THAT(ErrorOf([] { LinearStencil(0.5, 1); }),
              IsError(ErrorKind::kRange, {.key = "the number of bins", .value = "1"}));
  EXPECT_THAT(ErrorOf([] { ProjectedIntegral(Axis::Utia(), std::vector<double>(3)); }),
              IsError(ErrorKind::kMismatch, {.key = "D", .value = "3"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
