#include "appearance/render_environment.h"

#include <cmath>
#include <vector>

#include "appearance/color.h"
#include "appearance/mirrored_environment.h"
#include "appearance/prepared_light.h"

namespace trilobe {
namespace {

// The light that the half vectors of a cell send to the eye.
class CellLights {
 public:
  CellLights(const Environment& environment, const View& view)
      : mirrored_(environment), view_(view) {}

  int size() const { return static_cast<int>(cells_.size()); }

  // Of a cell about the normal of a point. Calls `set_angles(cell, half, light, incident)` if it is
  // above the surface, and then `irradiance` holds.
  template <typename Angles, typename SetAngles>
  Incident<Angles> On(int point, int cell, const SetAngles& set_angles) const {
    const HalfCell& about = cells_[cell];
    const Direction half = Turned(view_.points[point].normal, about.half);
    if (!(half[2] > 0)) return {};
    const Direction light = {2 * half[2] * half[0], 2 * half[2] * half[1],
                             2 * half[2] * half[2] - 1};
    Incident<Angles> incident{.cosines = CosinesOver(view_.points[point], light)};
    if (!(incident.cosines.i > 0)) return incident;
    set_angles(about, half, light, &incident);
    incident.irradiance = mirrored_.Mean(half, about.solid_angle);
    const double light_angle = 4 * half[2] * about.solid_angle;
    for (double& x : incident.irradiance) x *= light_angle;
    incident.weight = Luminance(incident.irradiance);
    return incident;
  }

 private:
  // By the smallest turn that takes z to the normal, which is no sudden one where the eye looks.
  static Direction Turned(const Direction& n, const Direction& v) {
    const double along = (n[0] * v[0] + n[1] * v[1]) / (1 + n[2]);
    return {v[0] - n[0] * along + n[0] * v[2], v[1] - n[1] * along + n[1] * v[2],
            n[2] * v[2] - n[0] * v[0] - n[1] * v[1]};
  }

  const MirroredEnvironment mirrored_;
  const View& view_;
  const std::vector<HalfCell>& cells_ = HalfCells();
};

}  // namespace

RenderedImages RenderUnder(const Environment& environment, const View& view,
                           std::span<const SphericalBrdf> materials,
                           const std::function<bool(const SphericalAngles&)>& counts,
                           int num_threads) {
  const CellLights lights(environment, view);
  return RenderBy(
      view, lights.size(), static_cast<int>(materials.size()),
      [&](int k, int cell) {
        return lights.On<SphericalAngles>(
            k, cell,
            [&](const HalfCell&, const Direction&, const Direction& light, auto* incident) {
              const SurfacePoint& point = view.points[k];
              incident->angles = {std::acos(incident->cosines.i), PhiOver(point, light),
                                  std::acos(incident->cosines.o), PhiOver(point, kEye)};
            });
      },
      [&](int m, const SphericalAngles& at, const Cosines&) { return materials[m](at); },
      [&](const SphericalAngles& at, const Cosines&) { return counts(at); }, /*whole_too=*/true,
      num_threads);
}

RenderedImages RenderUnder(const Environment& environment, const View& view,
                           std::span<const AngularBrdf> materials,
                           const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts,
                           int num_threads) {
  const CellLights lights(environment, view);
  return RenderBy(
      view, lights.size(), static_cast<int>(materials.size()),
      [&](int k, int cell) {
        return lights.On<HalfDiffAngles>(
            k, cell,
            [&](const HalfCell& about, const Direction& half, const Direction&, auto* incident) {
              // As AnglesOver has it, the light being the eye's mirror image at the half vector.
              const double sine2 = half[0] * half[0] + half[1] * half[1];
              const Direction& normal = view.points[k].normal;
              const bool on_left = normal[1] * half[0] >= normal[0] * half[1];
              incident->angles = {
                  about.theta, AngleOfSine2(sine2),
                  PhiDOver(incident->cosines, about.sine, std::sqrt(sine2), on_left)};
            });
      },
      [&](int m, const HalfDiffAngles& angles, const Cosines& cosines) {
        return materials[m](angles, cosines);
      },
      counts, /*whole_too=*/true, num_threads);
}

}  // namespace trilobe
