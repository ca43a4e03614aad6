#include "trilobe/appearance/sphere.h"

#include <algorithm>
#include <cmath>

#include "trilobe/base/parallel.h"

namespace trilobe {
namespace {

double Dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// What the pixels have in common, since the eye is in the same direction (+z) from all of them.
struct PreparedLight {
  Light light;
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
  return {light, half, across, std::atan2(sin_d, Dot(half, l)), sin_d};
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

AngularBrdf Interpolated(const TabulatedBrdf& table) {
  return [&table](const HalfDiffAngles& angles, const Cosines& /*cosines*/) {
    return table.Interpolate(angles);
  };
}

std::vector<SphereImage> RenderSpheres(
    std::span<const AngularBrdf> materials, std::span<const Light> lights, int size,
    const std::function<bool(const HalfDiffAngles&, const Cosines&)>& counts, int num_threads) {
  const int pixels = size * size;
  std::vector<SphereImage> images(
      materials.size(), {size, std::vector<Rgb>(pixels), std::vector<double>(pixels, -1.0)});
  std::vector<PreparedLight> prepared;
  for (const Light& light : lights) prepared.push_back(Prepare(light));

  constexpr int kRows = 8;  // of pixels, an item of work
  ParallelFor((size + kRows - 1) / kRows, num_threads, [&](int item) {
    struct Pixel {
      int index;
      Direction normal;
      double light = 0, counted = 0;
    };
    std::vector<Pixel> visible;
    const int end = std::min(size, (item + 1) * kRows);
    for (int index = item * kRows * size; index < end * size; ++index) {
      const int row = index / size;
      const double x = (index % size + 0.5) / size * 2 - 1;
      const double y = 1 - (row + 0.5) / size * 2;
      const double z2 = 1 - x * x - y * y;
      if (z2 > 0) visible.push_back({index, {x, y, std::sqrt(z2)}});
    }
    // Pixel by pixel within a light: theta_d stays, and so does what tables are read there.
    for (const PreparedLight& light : prepared) {
      for (Pixel& pixel : visible) {
        const Cosines cosines{std::min(Dot(pixel.normal, light.light.direction), 1.0),
                              pixel.normal[2]};
        if (!(cosines.i > 0)) continue;
        const HalfDiffAngles angles = AnglesOver(pixel.normal, light, cosines);
        pixel.light += cosines.i;
        if (!counts(angles, cosines)) continue;
        pixel.counted += cosines.i;
        for (size_t k = 0; k < materials.size(); ++k) {
          const Rgb rho = materials[k](angles, cosines);
          Rgb& radiance = images[k].radiance[pixel.index];
          for (int c = 0; c < kChannels; ++c) {
            radiance[c] += rho[c] * cosines.i * light.light.irradiance[c];
          }
        }
      }
    }
    for (const Pixel& pixel : visible) {
      const double coverage = pixel.light > 0 ? pixel.counted / pixel.light : 1;
      for (SphereImage& image : images) image.coverage[pixel.index] = coverage;
    }
  });
  return images;
}

}  // namespace trilobe
