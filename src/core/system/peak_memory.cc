#include "core/system/peak_memory.h"

#include <fstream>
#include <limits>
#include <string>

namespace trilobe {

std::optional<int64_t> PeakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;) {
    int64_t kilobytes = 0;
    if (key == "VmHWM:" && status >> kilobytes) return 1024 * kilobytes;
    status.ignore(std::numeric_limits<std::streamsize>::max(), '\n');
  }
  return std::nullopt;
}

}  // namespace trilobe
