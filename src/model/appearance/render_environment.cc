#include "model/appearance/render_environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <span>
#include <vector>

#include "core/base/lanes.h"
#include "model/appearance/color.h"
#include "model/appearance/mirrored_environment.h"
#include "model/appearance/prepared_light.h"
#include "trilobe/core/base/check.h"

namespace trilobe {
namespace {

constexpr int kTurns = 4;

// The points of one quadrant of a sphere, x > 0 and y >= 0, and its centre; quarter turns map them
// to all others.
std::vector<SurfacePoint> FirstQuarter(const View& sphere) {
  std::vector<SurfacePoint> quarter;
  for (const SurfacePoint& point : sphere.points) {
    const auto [x, y, z] = point.normal;
    if (y >= 0 && (x > 0 || (x == 0 && y == 0))) quarter.push_back(point);
  }
  return quarter;
}

// Rotated by a quarter turn from x, right, towards y, up.
int Turned(int pixel, int size) { return (size - 1 - pixel % size) * size + pixel / size; }

// The light from a cell at a point and at its rotated copies.
struct CellLight {
  int point;
  bool counted;
  Direction half;
  double scale;  // of the mean radiance: solid angle times cos theta_i
};

// Sums of radiance for each turn; the last lane sums the luminance of the light.
using Sums = std::array<Pixel, kTurns>;

// Adds the light of a cell to the sums [point][material]{of all, of what counts}. `values` are
// those of the materials at each light in turn, with 1 in the last lane.
TRILOBE_MULTIVERSION void AddLights(const MirroredEnvironment& mirrored, double solid_angle,
                                    const std::vector<CellLight>& lights, const Pixel* values,
                                    int materials, Sums* sums) {
  for (const CellLight& light : lights) {
    Four<double> means[kTurns];
    mirrored.SetMeans<kTurns>(light.half, solid_angle, means);
    for (int m = 0; m < materials; ++m) {
      const Four<double> value = light.scale * Load((values++)->lane);
      Sums* const of_light = &sums[(light.point * materials + m) * 2];
      for (int turn = 0; turn < kTurns; ++turn) {
        const Four<double> seen = value * means[turn];
        for (int set = 0; set <= (light.counted ? 1 : 0); ++set) {
          double* const sum = of_light[set][turn].lane;
          Store<double>(Load(sum) + seen, sum);
        }
      }
    }
  }
}

// The sums of AddLights for some points.
std::vector<Sums> SumsOf(std::span<const SurfacePoint> points, const MirroredEnvironment& mirrored,
                         std::span<const AngularBrdf> materials,
                         const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts) {
  const int count = static_cast<int>(materials.size());
  std::vector<Sums> sums(points.size() * count * 2);
  std::vector<CellLight> lights;
  std::vector<Pixel> values;
  // All points for one cell at a time: they read nearby table entries, which stay cached.
  for (const HalfCell& cell : HalfCells()) {
    lights.clear();
    values.clear();
    for (size_t k = 0; k < points.size(); ++k) {
      const Direction& normal = points[k].normal;
      const Direction half = cell.HalfVectorAbout(normal);
      if (!(half[2] > 0)) continue;
      const Cosines cosines = CosinesOver(points[k], MirroredEye(half));
      if (!(cosines.i > 0)) continue;
      // Same as AnglesOver; the light is the eye's mirror image at the half vector.
      const double sine2 = half[0] * half[0] + half[1] * half[1];
      const bool on_left = normal[1] * half[0] >= normal[0] * half[1];
      const HalfDiffAngles angles = {cell.theta, AngleOfSine2(sine2),
                                     PhiDOver(cosines, cell.sine, std::sqrt(sine2), on_left)};
      lights.push_back({static_cast<int>(k), counts(angles, cosines), half,
                        4 * half[2] * cell.solid_angle * cosines.i});
      for (const AngularBrdf& material : materials) {
        const Rgb rho = material(angles, cosines);
        values.push_back({rho[0], rho[1], rho[2], 1});
      }
    }
    AddLights(mirrored, cell.solid_angle, lights, values.data(), count, sums.data());
  }
  return sums;
}

}  // namespace

RenderedImages RenderUnder(const Environment& environment, const View& view,
                           std::span<const SphericalBrdf> materials,
                           const std::function<bool(const SphericalAngles&)>& counts,
                           int num_threads) {
  const MirroredEnvironment mirrored(environment);
  const std::vector<HalfCell>& cells = HalfCells();
  return RenderBy(
      view, static_cast<int>(cells.size()), static_cast<int>(materials.size()),
      [&](int k, int number) -> Incident<SphericalAngles> {
        const HalfCell& cell = cells[number];
        const SurfacePoint& point = view.points[k];
        const Direction half = cell.HalfVectorAbout(point.normal);
        if (!(half[2] > 0)) return {};
        const Direction light = MirroredEye(half);
        Incident<SphericalAngles> incident{.cosines = CosinesOver(point, light)};
        if (!(incident.cosines.i > 0)) return incident;
        incident.angles = {std::acos(incident.cosines.i), PhiOver(point, light),
                           std::acos(incident.cosines.o), PhiOver(point, kEye)};
        incident.irradiance = mirrored.Mean(half, cell.solid_angle);
        const double light_angle = 4 * half[2] * cell.solid_angle;
        for (double& x : incident.irradiance) x *= light_angle;
        incident.weight = Luminance(incident.irradiance);
        return incident;
      },
      [&](int m, const SphericalAngles& at, const Cosines&) { return materials[m](at); },
      [&](const SphericalAngles& at, const Cosines&) { return counts(at); }, /*whole_too=*/true,
      num_threads);
}

RenderedImages RenderSphereUnder(
    const Environment& environment, int size, std::span<const AngularBrdf> materials,
    const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts, int num_threads) {
  for (const AngularBrdf& material : materials) CheckNotEmpty(material, "a material");
  CheckNotEmpty(counts, "counts");
  const MirroredEnvironment mirrored(environment);
  const std::vector<SurfacePoint> quarter = FirstQuarter(ViewSphere(size));
  const size_t pixels = static_cast<size_t>(size) * size, count = materials.size();
  const RenderedImage black = {size, std::vector<Rgb>(pixels), std::vector<double>(pixels, -1.0)};
  RenderedImages images{std::vector<RenderedImage>(count, black),
                        std::vector<RenderedImage>(count, black)};
  constexpr size_t kPoints = 256;  // an item of work
  const auto items = static_cast<int>((quarter.size() + kPoints - 1) / kPoints);
  ParallelFor(items, num_threads, [&](int item) {
    const size_t begin = item * kPoints;
    const auto points =
        std::span(quarter).subspan(begin, std::min(kPoints, quarter.size() - begin));
    const std::vector<Sums> sums = SumsOf(points, mirrored, materials, counts);
    for (size_t k = 0; k < points.size(); ++k) {
      int pixel = points[k].pixel;
      for (int turn = 0; turn < kTurns; ++turn, pixel = Turned(pixel, size)) {
        for (size_t m = 0; m < count; ++m) {
          const Sums* const of_point = &sums[(k * count + m) * 2];
          const auto& all = of_point[0][turn].lane;
          const auto& counted = of_point[1][turn].lane;
          images.whole[m].radiance[pixel] = {all[0], all[1], all[2]};
          images.counted[m].radiance[pixel] = {counted[0], counted[1], counted[2]};
          const double coverage = all[3] > 0 ? counted[3] / all[3] : 1;
          images.whole[m].coverage[pixel] = images.counted[m].coverage[pixel] = coverage;
        }
      }
    }
  });
  return images;
}

}  // namespace trilobe
