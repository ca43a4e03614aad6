#include "core/system/process.h"

#include <gtest/gtest.h>

#include <vector>

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(PeakMemory, CountsWhatWasTouchedAndKeepsIt) {
  const auto before = PeakMemory();
  ASSERT_TRUE(before);
  constexpr int64_t kBytes = 64 << 20;
  { const std::vector<char> touched(*before + kBytes, 1); }
  EXPECT_GE(*PeakMemory(), *before + kBytes);
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
