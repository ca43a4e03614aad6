#ifndef TRILOBE_CORE_SYSTEM_PEAK_MEMORY_H_
#define TRILOBE_CORE_SYSTEM_PEAK_MEMORY_H_

#include <cstdint>
#include <optional>

namespace trilobe {

// The most memory that this process has had resident so far [bytes], as Linux counts it for the
// program that runs (VmHWM); nothing where it does not say. getrusage would count what the process
// was before it became this program, too.
std::optional<int64_t> PeakMemory();

}  // namespace trilobe

#endif  // TRILOBE_CORE_SYSTEM_PEAK_MEMORY_H_
