// ParseUtia on arbitrary bytes, and on a file of the right size that repeats them, with the
// radiometry that the first byte says; what it accepts must be scattered samples that keep their
// promises.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "check_measurement.h"
#include "trilobe/base/error.h"
#include "trilobe/io/content.h"
#include "trilobe/io/utia_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  const auto& radiometries = trilobe::UtiaRadiometries();
  const std::string& radiometry = radiometries[data[0] % radiometries.size()].name;
  const std::string_view given(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    trilobe::ParseUtia(given, "fuzz", radiometry);
  } catch (const trilobe::Error&) {
  }
  std::string bytes;
  while (bytes.size() < trilobe::kUtiaSize) bytes += given;
  bytes.resize(trilobe::kUtiaSize);
  trilobe::CheckScattered(trilobe::ParseUtia(bytes, "fuzz", radiometry));
  return 0;
}
