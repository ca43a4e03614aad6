#include "fit/finish/limit_light.h"

#include <gtest/gtest.h>

#include <string>

#include "fit/finish/light_bounds.h"
#include "trilobe/model/load_model.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// These models once reflected 1.1, 1.8 and 1.6 times the light, between the angles looked at.
TEST(LightLimit, HoldsForModelsThatComeWithTheProgram) {
  for (const char* const name : {"aurora_white", "vch_ultra_pink", "charmeuse"}) {
    const FactorModel model = LoadModel(std::string("material:") + name).model;
    EXPECT_LE(PeakLight(model, 2).albedo, 1 + 5e-3) << name;
    // At each half degree and 5 degrees of azimuth, too, between which charmeuse had 2.3.
    EXPECT_TRUE(ExceededBounds({1.001, 1.001, 1.001}, model, 2).empty()) << name;
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
