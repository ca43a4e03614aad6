#include "trilobe/core/system/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "core/system/evaluation_count.h"
#include "trilobe/core/base/check.h"

namespace trilobe {
namespace {

// Idle threads, shared by jobs that run side by side.
class IdleThreads {
 public:
  explicit IdleThreads(int count) : count_(count) {}

  void Add(int count) { count_ += count; }

  // Takes as many of `wanted` as are idle.
  int Take(int wanted) {
    int there = count_, taken = 0;
    do {
      taken = std::clamp(wanted, 0, there);
    } while (taken > 0 && !count_.compare_exchange_weak(there, there - taken));
    return taken;
  }

 private:
  std::atomic<int> count_;
};

// The threads that may help this one; null outside a job.
thread_local IdleThreads* helpers = nullptr;

void RunOnThreads(int count, int num_threads, const std::function<void(int)>& work) {
  if (num_threads <= 1) {
    for (int i = 0; i < count; ++i) work(i);
    return;
  }
  std::atomic<int> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto run = [&, count_here = CountHere()] {
    const CountEvaluations counting(count_here);
    try {
      for (int i = next++; i < count; i = next++) work(i);
    } catch (...) {
      next = count;
      const std::lock_guard<std::mutex> lock(mutex);
      if (!failure) failure = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> threads;
    threads.reserve(num_threads - 1);
    try {
      for (int t = 1; t < num_threads; ++t) threads.emplace_back(run);
    } catch (const std::system_error&) {  // no more threads: the existing ones do all items
    }
    run();
  }
  if (failure) std::rethrow_exception(failure);
}

// Calls something at the end of a scope.
template <typename F>
class AtExit {
 public:
  explicit AtExit(F call) : call_(std::move(call)) {}
  ~AtExit() { call_(); }
  AtExit(const AtExit&) = delete;
  AtExit& operator=(const AtExit&) = delete;

 private:
  const F call_;
};

}  // namespace

void ParallelFor(int count, int num_threads, const std::function<void(int)>& work) {
  CheckNumThreads(num_threads);
  CheckNotEmpty(work, "work");
  const int own = std::clamp(count, 0, num_threads);
  const int lent = helpers != nullptr ? helpers->Take(count - own) : 0;
  const AtExit give_back([lent] {
    if (lent > 0) helpers->Add(lent);
  });
  RunOnThreads(count, own + lent, work);
}

void ParallelForShort(int count, int num_threads, const std::function<void(int)>& work) {
  CheckNotEmpty(work, "work");
  constexpr int kBlock = 1 << 12;
  ParallelFor(count / kBlock + (count % kBlock > 0 ? 1 : 0), num_threads, [&](int block) {
    const int begin = block * kBlock, size = std::min(count - begin, kBlock);
    for (int i = begin; i < begin + size; ++i) work(i);
  });
}

void ParallelJobs(int count, int num_threads, const std::function<void(int)>& work) {
  CheckNumThreads(num_threads);
  CheckNotEmpty(work, "work");
  const int own = std::clamp(count, 0, num_threads);
  // A single-threaded job inside another one shares its helpers. Otherwise the helpers are the
  // threads without an item.
  IdleThreads spare(std::max(num_threads - own, 0));
  IdleThreads* const pool = helpers != nullptr && num_threads <= 1 ? helpers : &spare;
  const int threads = own + pool->Take(count - own);
  std::atomic<int> left{count};
  RunOnThreads(count, threads, [&](int i) {
    const AtExit done([&, outer = std::exchange(helpers, pool)] {
      helpers = outer;
      // With fewer items left than threads, this thread has no further item. The last to end
      // continues as the caller's thread.
      const int now = --left;
      if (now > 0 && now < threads) pool->Add(1);
    });
    work(i);
  });
}

}  // namespace trilobe
