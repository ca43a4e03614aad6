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

  // The same without restarting.
  double Seconds() const { return Stopwatch(*this).Lap(); }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

// The current time in ISO 8601: "2024-03-01T12:00:00Z".
std::string UtcNow();

// The processor of this machine: "Intel(R) Xeon(R) Platinum 8370C CPU @ 2.80GHz", or the
// architecture, as "aarch64", where Linux does not name it.
std::string ProcessorName();

// Seconds that all threads of this process have had of the processors since it began.
double ProcessorSeconds();

// Peak resident memory of this process [bytes], from Linux's VmHWM; nothing if not available.
// (getrusage also counts the process before exec.)
std::optional<int64_t> PeakMemory();

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_PROCESS_H_
