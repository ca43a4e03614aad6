#include "core/base/grid_cosines.h"

#include <gtest/gtest.h>

#include "tests/error_of.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(GridCosines, AreThoseOfTheCentersToTheBit) {
  for (const MerlGrid& grid : {MerlGrid{}, MerlGrid{.theta_h = 4, .theta_d = 5, .phi_d = 7}}) {
    const GridCosines cosines(grid);
    int unequal = 0;
    for (int bin = 0; bin < grid.size(); ++bin) {
      const auto [i, o] = ToCosines(grid.Center(bin));
      unequal += cosines(bin).i != i || cosines(bin).o != o;
    }
    EXPECT_EQ(unequal, 0);
  }
}

TEST(GridCosines, AreNotOfAGridThatIsNone) {
  EXPECT_THAT(ErrorOf([&] { GridCosines(MerlGrid{.theta_h = 0}); }),
              IsError(ErrorKind::kRange, {.key = "grid of bins"}));
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
