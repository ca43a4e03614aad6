#include "trilobe/appearance/render.h"

#include <cmath>

#include "trilobe/base/check.h"

namespace trilobe {

RenderedImages Render(const View& view, std::span<const SphericalBrdf> materials,
                      std::span<const Light> lights,
                      const std::function<bool(const SphericalAngles&)>& counts, bool whole_too,
                      int num_threads) {
  for (const SphericalBrdf& material : materials) CheckNotEmpty(material, "a material");
  CheckNotEmpty(counts, "counts");
  const auto phi = [](const SurfacePoint& point, const Direction& to) {
    return std::atan2(Dot(to, point.y), Dot(to, point.x));
  };
  std::vector<PolarAngles> eye;  // [view.points.size()]
  for (const SurfacePoint& point : view.points) {
    eye.push_back({std::acos(std::min(Dot(point.normal, kEye), 1.0)), phi(point, kEye)});
  }
  return RenderBy(
      view, lights, static_cast<int>(materials.size()),
      [&](int k, int light, const Cosines& cosines) {
        return SphericalAngles{std::acos(cosines.i), phi(view.points[k], lights[light].direction),
                               eye[k].theta, eye[k].phi};
      },
      [&](int m, const SphericalAngles& at, const Cosines&) { return materials[m](at); },
      [&](const SphericalAngles& at, const Cosines&) { return counts(at); }, whole_too,
      num_threads);
}

}  // namespace trilobe
