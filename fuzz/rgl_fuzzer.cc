// RglBrdf::Parse on arbitrary bytes; what it accepts must be finite and >= 0 in all directions, and
// its samples, where it is anisotropic, must keep their promises.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "check_measurement.h"
#include "io/formats/rgl_file.h"
#include "trilobe/core/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const trilobe::Direction directions[] = {{0, 0, 1},          {0.6, 0, 0.8}, {0, -0.8, 0.6},
                                           {-0.6, 0.64, 0.48}, {-1, 0, 1e-9}, {0.6, 0, -0.8}};
  std::optional<trilobe::RglBrdf> brdf;
  try {
    brdf = trilobe::RglBrdf::Parse(bytes, "fuzz");
  } catch (const trilobe::Error&) {
    return 0;
  }
  for (const trilobe::Direction& wi : directions) {
    for (const trilobe::Direction& wo : directions) {
      for (const double rho : brdf->Evaluate({wi, wo})) {
        if (!std::isfinite(rho) || rho < 0) std::abort();
      }
    }
  }
  if (brdf->isotropic()) return 0;
  for (const bool extrapolated : {false, true}) {
    trilobe::CheckScattered(brdf->Sample("fuzz", extrapolated));
  }
  return 0;
}
