#ifndef TRILOBE_CORE_SYSTEM_PARALLEL_H_
#define TRILOBE_CORE_SYSTEM_PARALLEL_H_

#include <functional>

namespace trilobe {

// Calls work(i) once for every i in [0, count) on at most num_threads >= 1 threads, or fewer if the
// system provides fewer. Items are handed out one by one, so their costs may differ, and in
// ascending order, so an item may wait for earlier ones if these do not throw. Results are
// independent of the number of threads if each item writes only its own output; reduce afterwards,
// in item order. The first exception thrown by an item is rethrown here after all threads have
// stopped. Throws Error for num_threads < 1 or an empty `work`.
void ParallelFor(int count, int num_threads, const std::function<void(int)>& work);

// The same for many short items, which are handed out in blocks of thousands.
void ParallelForShort(int count, int num_threads, const std::function<void(int)>& work);

// The same for a few long items. Idle threads help in nested ParallelFor and ParallelJobs calls of
// other items, in addition to the num_threads that these calls request.
void ParallelJobs(int count, int num_threads, const std::function<void(int)>& work);

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_PARALLEL_H_
