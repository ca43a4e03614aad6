#ifndef TRILOBE_CORE_SYSTEM_STOPWATCH_H_
#define TRILOBE_CORE_SYSTEM_STOPWATCH_H_

#include <chrono>

namespace trilobe {

class Stopwatch {
 public:
  // Seconds since construction or the last call.
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> lap = now - last_;
    last_ = now;
    return lap.count();
  }

  // The same, without beginning anew.
  double Seconds() const { return Stopwatch(*this).Lap(); }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_STOPWATCH_H_
