// RglBrdf::Parse on arbitrary bytes; what it accepts must be finite and >= 0 in all directions.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "trilobe/base/error.h"
#include "trilobe/io/rgl_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const trilobe::Direction directions[] = {{0, 0, 1},          {0.6, 0, 0.8}, {0, -0.8, 0.6},
                                           {-0.6, 0.64, 0.48}, {-1, 0, 1e-9}, {0.6, 0, -0.8}};
  try {
    const trilobe::RglBrdf brdf = trilobe::RglBrdf::Parse(bytes, "fuzz");
    for (const trilobe::Direction& wi : directions) {
      for (const trilobe::Direction& wo : directions) {
        for (const double rho : brdf.Evaluate({wi, wo})) {
          if (!std::isfinite(rho) || rho < 0) std::abort();
        }
      }
    }
  } catch (const trilobe::Error&) {
  }
  return 0;
}
