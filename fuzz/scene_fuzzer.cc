// ParseScene on arbitrary text, which must end in a scene that keeps its promises or in an Error;
// and ParseHistogram on the same bytes.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "fit/scene/scene_file.h"
#include "trilobe/core/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const trilobe::Scene scene = trilobe::ParseScene(text, "fuzz");
    if (scene.materials.empty()) std::abort();
  } catch (const trilobe::Error&) {
  }
  try {
    const trilobe::DirectionHistogram histogram = trilobe::ParseHistogram(text, "fuzz");
    if (histogram.counts.size() != static_cast<size_t>(histogram.grid.size())) std::abort();
  } catch (const trilobe::Error&) {
  }
  return 0;
}
