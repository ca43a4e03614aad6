#include "trilobe/io/plots.h"

#include <filesystem>

#include "trilobe/model/reconstruct.h"

namespace trilobe {

std::vector<std::string> DrawPictures(const ModelFile& file, const BrdfTable* measured,
                                      std::span<const IterationRecord> trace,
                                      const std::string& folder, int num_threads) {
  std::vector<std::string> paths;
  const auto add = [&](const char* name) -> const std::string& {
    return paths.emplace_back((std::filesystem::path(folder) / name).string());
  };
  DrawFactors(file, add("factors.png"));
  if (measured != nullptr) {
    const BrdfTable fitted = Reconstruct(file.model, "fit", measured->grid, num_threads);
    DrawSlices(*measured, fitted, add("slices.png"));
    DrawSpheres(*measured, fitted, add("spheres.png"), num_threads);
  }
  if (!trace.empty()) DrawTrace(trace, file.fit.source, add("trace.png"));
  return paths;
}

}  // namespace trilobe
