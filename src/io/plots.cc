#include "trilobe/io/plots.h"

#include <filesystem>
#include <functional>

#include "trilobe/base/parallel.h"
#include "trilobe/model/reconstruct.h"

namespace trilobe {

std::vector<std::string> DrawPictures(const ModelFile& file, const PictureData& measured,
                                      std::span<const IterationRecord> trace,
                                      const std::string& folder,
                                      const AppearanceOptions& appearance) {
  std::vector<std::string> paths;
  std::vector<std::function<void()>> drawings;
  const auto add = [&](const char* name, const auto& draw) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    paths.push_back(path);
    drawings.emplace_back([path, draw] { draw(path); });
  };
  const Material fitted = MaterialOf(file.model);
  if (measured.table != nullptr) CheckIsotropic(measured, fitted);
  add("factors.png", [&](const std::string& path) { DrawFactors(file, path); });
  if (measured.nodes) {
    const NodeBrdf& nodes = *measured.nodes;
    add("slices.png", [&](const std::string& path) { DrawSlices(nodes, fitted.spherical, path); });
    add("spheres.png",
        [&](const std::string& path) { DrawSpheres(nodes, fitted.spherical, path, appearance); });
    add("cloth.png",
        [&](const std::string& path) { DrawCloth(nodes, fitted.spherical, path, appearance); });
  } else if (measured.table != nullptr) {
    const BrdfTable& table = *measured.table;
    add("slices.png", [&](const std::string& path) {
      DrawSlices(table, Reconstruct(file.model, "fit", table.grid, appearance.num_threads), path);
    });
    add("spheres.png",
        [&](const std::string& path) { DrawSpheres(table, fitted.angular, path, appearance); });
  } else {
    add("spheres.png",
        [&](const std::string& path) { DrawFittedSphere(fitted, path, appearance); });
  }
  if (!trace.empty()) {
    add("trace.png", [&](const std::string& path) { DrawTrace(trace, file.fit.source, path); });
  }
  // All at once: those that are not rendered wait for gnuplot, which has one thread.
  const int count = static_cast<int>(drawings.size());
  ParallelFor(count, appearance.num_threads > 1 ? count : 1, [&](int k) { drawings[k](); });
  return paths;
}

}  // namespace trilobe
