#include "trilobe/appearance/sphere.h"

#include <algorithm>
#include <cmath>

#include "trilobe/base/check.h"

namespace trilobe {
namespace {

// What the pixels have in common, since the eye is in the same direction (+z) from all of them.
struct PreparedLight {
  Direction half;    // between light and eye
  Direction across;  // half x light: at right angles to the plane of light and eye
  double theta_d, sin_d;
};

PreparedLight Prepare(const Light& light) {
  const Direction& l = light.direction;
  Direction half = {l[0], l[1], l[2] + 1};
  const double length = std::max(std::hypot(half[0], half[1], half[2]), 1e-150);
  for (double& x : half) x /= length;
  const Direction across = {half[1] * l[2] - half[2] * l[1], half[2] * l[0] - half[0] * l[2],
                            half[0] * l[1] - half[1] * l[0]};
  const double sin_d = std::hypot(across[0], across[1], across[2]);
  return {half, across, std::atan2(sin_d, Dot(half, l)), sin_d};
}

// The angles of light and eye over a surface with normal n.
HalfDiffAngles AnglesOver(const Direction& n, const PreparedLight& light, const Cosines& cosines) {
  const double cos_h = std::min(Dot(n, light.half), 1.0);
  const double sin_h = std::sqrt(1 - cos_h * cos_h);
  // cos theta_{i,o} = cos theta_h cos theta_d -+ sin theta_h sin theta_d cos phi_d.
  const double b = 2 * sin_h * light.sin_d;
  const double cos_phi = b > 0 ? std::clamp((cosines.o - cosines.i) / b, -1.0, 1.0) : 1.0;
  // phi_d below 0 is that of the exchanged directions, phi_d + pi.
  const double phi = std::acos(cos_phi);
  return {std::acos(cos_h), light.theta_d, Dot(n, light.across) >= 0 || phi == 0 ? phi : kPi - phi};
}

}  // namespace

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
             view, lights, static_cast<int>(materials.size()),
             [&](int k, int light, const Cosines& cosines) {
               return AnglesOver(view.points[k].normal, prepared[light], cosines);
             },
             [&](int m, const HalfDiffAngles& angles, const Cosines& cosines) {
               return materials[m](angles, cosines);
             },
             counts, /*whole_too=*/false, num_threads)
      .counted;
}

}  // namespace trilobe
