#include "trilobe/base/parallel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace trilobe {
namespace {

TEST(ParallelFor, CallsEveryItemOnce) {
  for (const int threads : {-1, 0, 1, 2, 7, 1000}) {
    for (const int count : {0, 1, 2, 100}) {
      std::vector<int> calls(count, 0);
      ParallelFor(count, threads, [&](int i) { ++calls[i]; });
      EXPECT_THAT(calls, testing::Each(1)) << count << " items, " << threads << " threads";
    }
  }
}

TEST(ParallelFor, DoesNothingForANegativeCount) {
  ParallelFor(-5, 4, [](int) { FAIL(); });
}

TEST(ParallelFor, RunsOnSeveralThreadsAtOnce) {
  // Each of the two items waits until the other has begun.
  std::atomic<int> begun{0};
  std::vector<std::thread::id> ids(2);
  ParallelFor(2, 2, [&](int i) {
    ids[i] = std::this_thread::get_id();
    ++begun;
    while (begun < 2) std::this_thread::yield();
  });
  EXPECT_NE(ids[0], ids[1]);
}

TEST(ParallelFor, RethrowsAndStopsHandingOut) {
  for (const int threads : {1, 4}) {
    std::atomic<int> calls{0};
    EXPECT_THROW(ParallelFor(1000000, threads,
                             [&](int) {
                               ++calls;
                               throw std::out_of_range("item");
                             }),
                 std::out_of_range);
    EXPECT_LE(calls, threads);
  }
}

}  // namespace
}  // namespace trilobe
