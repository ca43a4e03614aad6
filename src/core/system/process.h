#ifndef TRILOBE_CORE_SYSTEM_PROCESS_H_
#define TRILOBE_CORE_SYSTEM_PROCESS_H_

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

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

// The time now, ISO 8601: "2024-03-01T12:00:00Z".
std::string UtcNow();

// The most memory that this process has had resident so far [bytes], as Linux counts it for the
// program that runs (VmHWM); nothing where it does not say. getrusage would count what the process
// was before it became this program, too.
std::optional<int64_t> PeakMemory();

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_PROCESS_H_
