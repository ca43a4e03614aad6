// ParseMerl on arbitrary bytes, on a grid so small that inputs can be whole files; what it accepts
// must be what the bytes hold, bit for bit.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "io/formats/merl_file.h"
#include "trilobe/core/base/error.h"

namespace {

constexpr trilobe::MerlGrid kGrid{.theta_h = 2, .theta_d = 2, .phi_d = 3};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    trilobe::ParseMerl(bytes, "fuzz");
    std::abort();  // no input is long enough to be a MERL file of the usual grid
  } catch (const trilobe::Error&) {
  }
  try {
    const trilobe::BrdfTable table = trilobe::ParseMerl(bytes, "fuzz", kGrid);
    std::string stored;
    for (const auto& plane : table.stored) {
      stored.append(reinterpret_cast<const char*>(plane.data()), plane.size() * sizeof(double));
    }
    if (bytes.substr(12) != stored) std::abort();
  } catch (const trilobe::Error&) {
  }
  return 0;
}
