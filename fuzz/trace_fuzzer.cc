// ParseTrace on arbitrary text; what it accepts must survive being written and read again.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "trilobe/core/base/error.h"
#include "trilobe/io/model_files/trace_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  std::vector<trilobe::IterationRecord> records;
  try {
    records = trilobe::ParseTrace(text, "fuzz");
  } catch (const trilobe::Error&) {
    return 0;
  }
  if (trilobe::ParseTrace(trilobe::FormatTrace(records), "fuzz") != records) std::abort();
  return 0;
}
