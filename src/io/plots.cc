#include "trilobe/io/plots.h"

#include <filesystem>

#include "trilobe/model/continuous_model.h"
#include "trilobe/model/reconstruct.h"

namespace trilobe {

std::vector<std::string> DrawPictures(const ModelFile& file, const BrdfTable* measured,
                                      std::span<const IterationRecord> trace,
                                      const std::string& folder,
                                      const AppearanceOptions& appearance) {
  std::vector<std::string> paths;
  const auto add = [&](const char* name) -> const std::string& {
    return paths.emplace_back((std::filesystem::path(folder) / name).string());
  };
  DrawFactors(file, add("factors.png"));
  if (measured != nullptr) {
    const BrdfTable fitted = Reconstruct(file.model, "fit", measured->grid, appearance.num_threads);
    DrawSlices(*measured, fitted, add("slices.png"));
    DrawSpheres(*measured, ContinuousModel(file.model), add("spheres.png"), appearance);
  }
  if (!trace.empty()) DrawTrace(trace, file.fit.source, add("trace.png"));
  return paths;
}

}  // namespace trilobe
