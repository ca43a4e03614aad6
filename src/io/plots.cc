#include "trilobe/io/plots.h"

#include <filesystem>

#include "trilobe/model/reconstruct.h"

namespace trilobe {

std::vector<std::string> DrawPictures(const ModelFile& file, const PictureData& measured,
                                      std::span<const IterationRecord> trace,
                                      const std::string& folder,
                                      const AppearanceOptions& appearance) {
  std::vector<std::string> paths;
  const auto add = [&](const char* name) -> const std::string& {
    return paths.emplace_back((std::filesystem::path(folder) / name).string());
  };
  const Material fitted = MaterialOf(file.model);
  if (measured.table != nullptr) CheckIsotropic(measured, fitted);
  DrawFactors(file, add("factors.png"));
  if (measured.nodes) {
    DrawSlices(*measured.nodes, fitted.spherical, add("slices.png"));
    DrawSpheres(*measured.nodes, fitted.spherical, add("spheres.png"), appearance);
    DrawCloth(*measured.nodes, fitted.spherical, add("cloth.png"), appearance);
  } else if (measured.table != nullptr) {
    const BrdfTable& table = *measured.table;
    DrawSlices(table, Reconstruct(file.model, "fit", table.grid, appearance.num_threads),
               add("slices.png"));
    DrawSpheres(table, fitted.angular, add("spheres.png"), appearance);
  } else {
    DrawFittedSphere(fitted, add("spheres.png"), appearance);
  }
  if (!trace.empty()) DrawTrace(trace, file.fit.source, add("trace.png"));
  return paths;
}

}  // namespace trilobe
