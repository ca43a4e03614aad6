#include "model/appearance/render_environment.h"

#include <cmath>
#include <vector>

#include "model/appearance/color.h"
#include "model/appearance/mirrored_environment.h"

namespace trilobe {

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
        const Direction half = cell.About(point.normal);
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

}  // namespace trilobe
