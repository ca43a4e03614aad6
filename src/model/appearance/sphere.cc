#include "trilobe/model/appearance/sphere.h"

#include "model/appearance/prepared_light.h"
#include "trilobe/core/base/check.h"

namespace trilobe {
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
