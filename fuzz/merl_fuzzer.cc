// ParseMerl on arbitrary bytes, and on files of the right size with arbitrary numbers in them.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "trilobe/base/error.h"
#include "trilobe/io/merl_file.h"

namespace {

constexpr size_t kPlaneSize = sizeof(double) * 90 * 90 * 180;

// A whole file whose first numbers of each plane are `numbers`. It must be read, bit for bit.
void CheckWholeFile(std::string_view numbers) {
  static std::string file = [] {
    std::string bytes(12 + 3 * kPlaneSize, '\0');
    const int32_t dimensions[] = {90, 90, 180};
    std::memcpy(bytes.data(), dimensions, sizeof(dimensions));
    return bytes;
  }();
  for (size_t plane = 0; plane < 3; ++plane) {
    std::memcpy(file.data() + 12 + plane * kPlaneSize, numbers.data(), numbers.size());
  }
  const trilobe::BrdfTable table = trilobe::ParseMerl(file, "fuzz");
  for (size_t plane = 0; plane < 3; ++plane) {
    const std::string_view stored(reinterpret_cast<const char*>(table.stored[plane].data()),
                                  kPlaneSize);
    if (file.compare(12 + plane * kPlaneSize, kPlaneSize, stored) != 0) std::abort();
  }
}

}  // namespace

// The first byte picks the mode; whole files, which take milliseconds, are the rare one.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] == 0xff) {
    CheckWholeFile(bytes);
    return 0;
  }
  try {
    trilobe::ParseMerl(bytes, "fuzz");
    std::abort();  // no input is long enough to be a MERL file
  } catch (const trilobe::Error&) {
  }
  return 0;
}
