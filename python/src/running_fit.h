#ifndef TRILOBE_PYTHON_RUNNING_FIT_H_
#define TRILOBE_PYTHON_RUNNING_FIT_H_

#include <atomic>
#include <limits>
#include <mutex>
#include <tuple>

#include "core/system/process.h"
#include "trilobe/model/objective/iteration_record.h"

namespace trilobe::python {

// State shared by the thread that fits and the one that waits for it.
class RunningFit {
 public:
  void Stop() { stopped_ = true; }
  bool stopped() const { return stopped_; }

  // A fit that has begun ends when the limit is passed.
  void Begin() { begun_ = true; }
  void Limit(double seconds) { limit_ = seconds; }
  bool IsToEnd() const { return stopped_ || (begun_ && since_.Seconds() >= limit_); }

  void Show(const IterationRecord& record) {
    const std::lock_guard lock(mutex_);
    latest_ = record;
    ++count_;
  }

  // How many records there have been; iteration, seconds and E of the last.
  std::tuple<int, int, double, double> Latest() const {
    const std::lock_guard lock(mutex_);
    return {count_, latest_.iteration, latest_.seconds, latest_.minimised()};
  }

 private:
  std::atomic<bool> stopped_ = false, begun_ = false;
  const Stopwatch since_;
  double limit_ = std::numeric_limits<double>::infinity();
  mutable std::mutex mutex_;
  IterationRecord latest_;
  int count_ = 0;
};

}  // namespace trilobe::python

#endif  // TRILOBE_PYTHON_RUNNING_FIT_H_
