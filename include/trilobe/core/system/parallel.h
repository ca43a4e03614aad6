#ifndef TRILOBE_CORE_SYSTEM_PARALLEL_H_
#define TRILOBE_CORE_SYSTEM_PARALLEL_H_

#include <functional>

namespace trilobe {

// Calls work(i) once for every i in [0, count), from at most num_threads >= 1 threads, fewer where
// the system gives no more. Items are handed out
// one by one, so they may cost different amounts, and in ascending order, so that one may wait for
// those before it if these do not throw. Results are the same for any number of threads as
// long as each item writes only what is its own: reduce afterwards, in item order. The first
// exception thrown by an item is rethrown here, after all threads have stopped. Throws Error for
// fewer threads, and where there is no work.
void ParallelFor(int count, int num_threads, const std::function<void(int)>& work);

// The same for many and short items, which are handed out thousands at a time.
void ParallelForShort(int count, int num_threads, const std::function<void(int)>& work);

// The same for few and long items: threads that have no item, or none left, help in the ParallelFor
// and ParallelJobs that other items call, in addition to the num_threads that these ask for.
void ParallelJobs(int count, int num_threads, const std::function<void(int)>& work);

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_PARALLEL_H_
