#include "io/pictures/plots.h"

#include <algorithm>
#include <filesystem>
#include <functional>
#include <optional>

#include "io/pictures/gnuplot.h"
#include "model/appearance/picture_data.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {

namespace {

constexpr double kLargest = 1e200;

// No value of the model in the middle of its angles is beyond this.
double Bound(const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  double bound = 0;
  for (int c = 0; c < kChannels; ++c) {
    double sum = model.d()[c];
    for (int m = 0; m < spec.lobes; ++m) {
      const double G = std::ranges::max(model.G(m, c));
      sum +=
          model.s(m)[c] * std::ranges::max(model.D(m, c)) * std::ranges::max(model.F(m, c)) * G * G;
    }
    bound = std::max(bound, sum);
  }
  return bound;
}

}  // namespace

void CheckDrawable(const ModelFile& file, std::span<const IterationRecord> trace) {
  const std::string name = "the model" + (file.fit.source.empty() ? "" : " of " + file.fit.source);
  const double largest = std::ranges::max(file.model.parameters());
  if (!(std::max(largest, Bound(file.model)) <= kLargest)) {
    throw Error(ErrorKind::kData,
                name + " goes beyond 1e200, too far to draw; its factors are too large")
        .About("model", name);
  }
  for (const IterationRecord& record : trace) {
    const double E = std::max(record.objective, record.minimised());
    if (E <= kLargest && record.seconds <= kLargest) continue;
    throw Error(ErrorKind::kData, "row " + std::to_string(record.iteration) +
                                      " of the trace goes beyond 1e200, too far to draw")
        .About("trace", record.iteration);
  }
}

std::vector<std::string> DrawPictures(const ModelFile& file, const PictureData& measured,
                                      std::span<const IterationRecord> trace,
                                      const std::string& folder,
                                      const AppearanceOptions& appearance,
                                      const std::optional<SphereError>& sphere) {
  CheckDrawable(file, trace);
  std::vector<std::string> paths;
  std::vector<std::function<void()>> drawings;
  const auto add = [&](const char* name, const auto& draw) {
    const std::string path = (std::filesystem::path(folder) / name).string();
    paths.push_back(path);
    drawings.emplace_back([path, draw] { draw(path); });
  };
  const Material fitted = MaterialOf(file.model);
  std::optional<BrdfTable> sampled;
  if (measured.table != nullptr) CheckIsotropic(measured, fitted);
  RequireGnuplot();  // so that none is drawn where others cannot be
  add("factors.png", [&](const std::string& path) { DrawFactors(file, path); });
  if (measured.nodes) {
    const NodeBrdf& nodes = *measured.nodes;
    add("slices.png", [&](const std::string& path) { DrawSlices(nodes, fitted.spherical, path); });
    add("spheres.png", [&](const std::string& path) {
      DrawSpheres(nodes, fitted.spherical, path, appearance, sphere);
    });
    add("cloth.png",
        [&](const std::string& path) { DrawCloth(nodes, fitted.spherical, path, appearance); });
  } else if (measured.table != nullptr) {
    const BrdfTable& table = *measured.table;
    add("slices.png", [&](const std::string& path) {
      DrawSlices(table, Reconstruct(file.model, "fit", table.grid, appearance.num_threads), path);
    });
    add("spheres.png", [&](const std::string& path) {
      DrawSpheres(table, fitted.angular, path, appearance, sphere);
    });
  } else {
    if (measured.scattered != nullptr && HasSlices(*measured.scattered)) {
      add("slices.png", [&](const std::string& path) {
        DrawSlices(*measured.scattered, fitted.spherical, path);
      });
    }
    if (measured.scattered != nullptr && fitted.angular) {
      sampled = TableOfSamples(*measured.scattered);
    }
    add("spheres.png", [&](const std::string& path) {
      if (sampled) {
        DrawSpheres(*sampled, fitted.angular, path, appearance);
      } else {
        DrawFittedSphere(fitted, path, appearance);
      }
    });
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
