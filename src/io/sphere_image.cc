#include "trilobe/io/sphere_image.h"

#include <algorithm>
#include <cmath>

#include "trilobe/base/parallel.h"
#include "trilobe/model/tabulated_brdf.h"

namespace trilobe {
namespace {

// x to the right, y up, z towards the eye.
struct Light {
  Direction direction;
  double irradiance;
};

Direction Normalized(const Direction& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

double Dot(const Direction& a, const Direction& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

const Light kLights[] = {
    {Normalized({-0.55, 0.65, 0.75}), kPi},
    {Normalized({0.85, 0.05, 0.45}), 0.3 * kPi},
    {Normalized({0.25, -0.70, -0.67}), 0.6 * kPi},
};

// Radiance towards the eye from the point of the sphere whose normal is n, n.z > 0.
Rgb Shade(const TabulatedBrdf& brdf, const Direction& n) {
  const double sin_o = std::hypot(n[0], n[1]);
  // Tangent frame with the eye in its xz plane.
  const Direction t =
      sin_o > 0 ? Direction{-n[0] * n[2] / sin_o, -n[1] * n[2] / sin_o, sin_o} : Direction{1, 0, 0};
  const Direction b = {n[1] * t[2] - n[2] * t[1], n[2] * t[0] - n[0] * t[2],
                       n[0] * t[1] - n[1] * t[0]};
  Rgb radiance{};
  for (const Light& light : kLights) {
    const Direction& l = light.direction;
    const Direction wi = {Dot(l, t), Dot(l, b), Dot(l, n)};
    if (wi[2] <= 0) continue;
    const Rgb rho = brdf.Interpolate({wi, {sin_o, 0, n[2]}});
    for (int c = 0; c < kChannels; ++c) radiance[c] += rho[c] * wi[2] * light.irradiance;
  }
  return radiance;
}

}  // namespace

SphereImage RenderSphere(const BrdfTable& material, int size, int num_threads) {
  const TabulatedBrdf brdf(material);
  const int side = size * SphereImage::kSamples;
  SphereImage image{size, std::vector<Rgb>(side * side), std::vector<bool>(side * side)};
  constexpr double kRadius = 0.96;  // of half the picture
  const auto coordinate = [&](int i) { return ((i + 0.5) / side * 2 - 1) / kRadius; };
  ParallelFor(side, num_threads, [&](int row) {
    for (int column = 0; column < side; ++column) {
      const double x = coordinate(column), y = -coordinate(row);
      const double z2 = 1 - x * x - y * y;
      if (z2 > 0) image.radiance[row * side + column] = Shade(brdf, {x, y, std::sqrt(z2)});
    }
  });
  for (int row = 0; row < side; ++row) {  // apart: neighbours in a vector<bool> share a byte
    for (int column = 0; column < side; ++column) {
      const double x = coordinate(column), y = coordinate(row);
      image.on_sphere[row * side + column] = x * x + y * y < 1;
    }
  }
  return image;
}

double Luminance(const Rgb& color) {
  return 0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2];
}

double EncodeSrgb(double linear) {
  const double x = std::clamp(linear, 0.0, 1.0);
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

}  // namespace trilobe
