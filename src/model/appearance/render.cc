#include "trilobe/model/appearance/render.h"

#include <cmath>

#include "model/appearance/prepared_light.h"
#include "trilobe/core/base/check.h"

namespace trilobe {

RenderedImages Render(const View& view, std::span<const SphericalBrdf> materials,
                      std::span<const Light> lights,
                      const std::function<bool(const SphericalAngles&)>& counts, bool whole_too,
                      int num_threads) {
  for (const SphericalBrdf& material : materials) CheckNotEmpty(material, "a material");
  CheckNotEmpty(counts, "counts");
  std::vector<PolarAngles> eye;  // [view.points.size()]
  for (const SurfacePoint& point : view.points) {
    eye.push_back({std::acos(std::min(Dot(point.normal, kEye), 1.0)), PhiOver(point, kEye)});
  }
  return RenderBy(
      view, static_cast<int>(lights.size()), static_cast<int>(materials.size()),
      [&](int k, int l) {
        const Light& light = lights[l];
        Incident<SphericalAngles> incident{.cosines = CosinesOver(view.points[k], light.direction)};
        if (!(incident.cosines.i > 0)) return incident;
        incident.angles = {std::acos(incident.cosines.i), PhiOver(view.points[k], light.direction),
                           eye[k].theta, eye[k].phi};
        incident.irradiance = light.irradiance;
        return incident;
      },
      [&](int m, const SphericalAngles& at, const Cosines&) { return materials[m](at); },
      [&](const SphericalAngles& at, const Cosines&) { return counts(at); }, whole_too,
      num_threads);
}

std::vector<RenderedImage> RenderSpheres(
    std::span<const AngularBrdf> materials, std::span<const Light> lights, int size,
    const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts, int num_threads,
    int every) {
  for (const AngularBrdf& material : materials) CheckNotEmpty(material, "a material");
  CheckNotEmpty(counts, "counts");
  const View view = ViewSphere(size, every);
  std::vector<PreparedLight> prepared;
  for (const Light& light : lights) prepared.push_back(Prepare(light));
  return RenderBy(
             view, static_cast<int>(lights.size()), static_cast<int>(materials.size()),
             [&](int k, int l) {
               Incident<HalfDiffAngles> incident{
                   .cosines = CosinesOver(view.points[k], lights[l].direction)};
               if (!(incident.cosines.i > 0)) return incident;
               incident.angles = AnglesOver(view.points[k].normal, prepared[l], incident.cosines);
               incident.irradiance = lights[l].irradiance;
               return incident;
             },
             [&](int m, const HalfDiffAngles& angles, const Cosines& cosines) {
               return materials[m](angles, cosines);
             },
             counts, /*whole_too=*/false, num_threads)
      .counted;
}

}  // namespace trilobe
