// ParseProbe on arbitrary bytes; what it accepts must be finite and >= 0, and give finite lights.

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "io/pictures/image_file.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/appearance/environment.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    const trilobe::Environment probe = trilobe::ParseProbe(bytes, "fuzz");
    if (probe.radiance.size() != static_cast<size_t>(probe.width) * probe.height) std::abort();
    for (const trilobe::Rgb& radiance : probe.radiance) {
      for (const double x : radiance) {
        if (!std::isfinite(x) || x < 0) std::abort();
      }
    }
    for (const trilobe::Light& light : DrawLights(probe, 30)) {
      for (int k = 0; k < 3; ++k) {
        if (!std::isfinite(light.direction[k]) || !std::isfinite(light.irradiance[k])) std::abort();
      }
    }
  } catch (const trilobe::Error&) {
  }
  return 0;
}
