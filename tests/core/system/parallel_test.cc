#include "trilobe/core/system/parallel.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

#include "tests/core/base/no_threads.h"
#include "tests/error_of.h"
#include "trilobe/core/base/error.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Whether something comes to hold; a thread that waits for what never comes fails its test after a
// minute instead of hanging.
template <typename Condition>
bool ComesToHold(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

TEST(ParallelFor, CallsEveryItemOnce) {
  for (const int threads : {1, 2, 7, 1000}) {
    for (const int count : {0, 1, 2, 100}) {
      std::vector<int> calls(count, 0);
      ParallelFor(count, threads, [&](int i) { ++calls[i]; });
      EXPECT_THAT(calls, testing::Each(1)) << count << " items, " << threads << " threads";
    }
  }
}

TEST(ParallelForShort, CallsEveryItemOnce) {
  for (const int count : {-1, 0, 1, 4095, 4096, 4097, 20000}) {
    std::vector<int> calls(std::max(count, 0), 0);
    ParallelForShort(count, 3, [&](int i) { ++calls[i]; });
    EXPECT_THAT(calls, testing::Each(1)) << count;
  }
}

TEST(ParallelFor, NeedsAThreadAndWork) {
  for (const auto& parallel : {ParallelFor, ParallelForShort, ParallelJobs}) {
    for (const int threads : {-1, 0}) {
      EXPECT_THAT(ErrorOf([&] { parallel(1, threads, [](int) {}); }),
                  IsError(ErrorKind::kRange, {.key = "num_threads"}));
    }
    EXPECT_THAT(ErrorOf([&] { parallel(1, 1, nullptr); }),
                IsError(ErrorKind::kMissing, {.key = "work"}));
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
    EXPECT_TRUE(ComesToHold([&] { return begun == 2; }));
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

TEST(ParallelFor, GoesOnAloneWhereThereIsNoThread) {
  const NoThreads none;
  EXPECT_THROW(std::jthread([] {}), std::system_error);
  std::vector<int> calls(100, 0);
  const auto work = [&, here = std::this_thread::get_id()](int i) {
    EXPECT_EQ(std::this_thread::get_id(), here);
    ++calls[i];
  };
  ParallelFor(100, 4, work);
  EXPECT_THAT(calls, testing::Each(1));
  // Jobs whose threads never came do not wait for them, nor do the loops that they would help.
  ParallelJobs(2, 4, [&](int half) { ParallelFor(50, 1, [&](int i) { work(50 * half + i); }); });
  EXPECT_THAT(calls, testing::Each(2));
  EXPECT_THROW(ParallelFor(100, 4, [](int) { throw std::out_of_range("item"); }),
               std::out_of_range);
}

TEST(ParallelJobs, CallsEveryItemOnce) {
  for (const int threads : {1, 2, 7, 1000}) {
    for (const int count : {-1, 0, 1, 2, 100}) {
      std::vector<int> calls(std::max(count, 0), 0);
      ParallelJobs(count, threads, [&](int i) { ++calls[i]; });
      EXPECT_THAT(calls, testing::Each(1)) << count << " items, " << threads << " threads";
    }
  }
}

// Two items, each of which waits until the other has begun, as one thread alone never could.
void TwoAtOnce() {
  std::atomic<int> begun{0};
  ParallelFor(2, 1, [&](int) {
    ++begun;
    EXPECT_TRUE(ComesToHold([&] { return begun == 2; }));
  });
}

TEST(ParallelJobs, ThreadsWithoutAnItemHelpTheOthers) {
  ParallelJobs(1, 2, [](int) {
    TwoAtOnce();
    TwoAtOnce();  // the helper has come back
    EXPECT_THROW(ParallelFor(2, 1, [](int) { throw std::out_of_range("item"); }),
                 std::out_of_range);
    TwoAtOnce();
  });
  std::set<std::thread::id> ids;
  ParallelFor(100, 1, [&](int) { ids.insert(std::this_thread::get_id()); });  // no job any more
  EXPECT_EQ(ids.size(), 1U);
}

TEST(ParallelJobs, ThreadsThatHaveEndedHelpTheOthers) {
  std::atomic<bool> ended{false};
  ParallelJobs(2, 2, [&](int i) {
    if (i == 0) {
      ended = true;
      return;
    }
    EXPECT_TRUE(ComesToHold([&] { return ended.load(); }));
    // The other thread has ended its item, and is idle soon.
    std::set<std::thread::id> ids;
    std::mutex mutex;
    EXPECT_TRUE(ComesToHold([&] {
      ParallelFor(2, 1, [&](int) {
        const std::lock_guard<std::mutex> lock(mutex);
        ids.insert(std::this_thread::get_id());
      });
      return ids.size() == 2;
    }));
  });
}

TEST(ParallelJobs, JobsWithinAJobShareItsHelpers) {
  ParallelJobs(1, 3, [](int) {
    std::atomic<int> begun{0};
    ParallelJobs(2, 1, [&](int i) {
      ++begun;
      EXPECT_TRUE(ComesToHold([&] { return begun == 2; }));
      if (i == 0) TwoAtOnce();  // with the third thread
    });
    TwoAtOnce();
  });
}

TEST(ParallelJobs, RethrowsAndGoesOnLendingAfterwards) {
  EXPECT_THROW(ParallelJobs(3, 2,
                            [](int i) {
                              if (i == 1) throw std::out_of_range("item");
                            }),
               std::out_of_range);
  ParallelJobs(1, 2, [](int) { TwoAtOnce(); });
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
