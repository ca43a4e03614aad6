// ParseMbsdf on arbitrary bytes; what it accepts must be scattered samples that keep their
// promises.

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "check_measurement.h"
#include "io/formats/mbsdf_file.h"
#include "trilobe/core/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  trilobe::Measurement measurement;
  try {
    measurement = trilobe::ParseMbsdf(bytes, "fuzz");
  } catch (const trilobe::Error&) {
    return 0;
  }
  trilobe::CheckScattered(measurement);
  return 0;
}
