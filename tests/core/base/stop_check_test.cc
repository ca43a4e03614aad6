#include "trilobe/core/base/stop_check.h"

#include <gtest/gtest.h>

#include <functional>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(StopCheck, AsksWhatItWasGiven) {
  bool stop = false;
  const StopCheck check = [&] { return stop; };
  const StopCheck copy = check;
  EXPECT_FALSE(copy());
  stop = true;
  EXPECT_TRUE(copy());
}

TEST(StopCheck, NeverStopsIfEmpty) {
  EXPECT_FALSE(StopCheck()());
  EXPECT_FALSE(StopCheck(nullptr)());
  EXPECT_FALSE(StopCheck(std::function<bool()>())());
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
