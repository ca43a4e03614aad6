#include "trilobe/model/appearance/view.h"

#include <algorithm>
#include <cmath>

#include "model/appearance/color.h"
#include "trilobe/core/base/check.h"

namespace trilobe {
namespace {

Direction Cross(const Direction& a, const Direction& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Direction Normalized(const Direction& v) {
  const double length = std::hypot(v[0], v[1], v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

void CheckImageSize(int size) {
  constexpr int kMost = 1 << 13;
  CheckNumber("the size of a picture", size, size >= 1 && size <= kMost,
              "from 1 to " + std::to_string(kMost) + " pixels");
}

// --- Cloth --------------------------------------------------------------------------------------

// The height of the folds over a point (u, v) of the flat cloth, and its slopes, which stay below
// 1.1: a sum of sines.
struct Fold {
  double height = 0, u = 0, v = 0;
};
Fold FoldAt(double u, double v) {
  struct Wave {
    double height, u, v, phase;
  };
  constexpr Wave kWaves[] = {
      {0.12, 5.6, 0.9, 0.6}, {0.055, -2.9, 2.4, 1.7}, {0.022, 9.1, -2.2, 0.9}};
  Fold fold;
  for (const Wave& wave : kWaves) {
    const double angle = wave.u * u + wave.v * v + wave.phase;
    fold.height += wave.height * std::sin(angle);
    fold.u += wave.height * wave.u * std::cos(angle);
    fold.v += wave.height * wave.v * std::cos(angle);
  }
  return fold;
}

const double kLean = DegreesToRadians(30);
// Axes of the flat cloth in the world: u, v and the normal.
const Direction kU = {1, 0, 0}, kV = {0, std::cos(kLean), -std::sin(kLean)},
                kUp = {0, std::sin(kLean), std::cos(kLean)};

// The point of the cloth that a ray at (x, y) of the picture meets: (u, v) with u = x and
// v cos(lean) + height sin(lean) = y. The left side grows with v, as slopes are below
// 1 / tan(lean); so Newton's method finds the only v.
double VAt(double x, double y) {
  double v = y / kV[1];
  for (int step = 0; step < 12; ++step) {
    const Fold fold = FoldAt(x, v);
    v -= (v * kV[1] + fold.height * kUp[1] - y) / (kV[1] + fold.v * kUp[1]);
  }
  return v;
}

Direction Combined(double u, double v, double up) {
  Direction sum;
  for (int k = 0; k < 3; ++k) sum[k] = u * kU[k] + v * kV[k] + up * kUp[k];
  return sum;
}

// A unit vector in the plane of the flat cloth.
struct Thread {
  double u = 1, v = 0;
};

Thread AlongLight(std::span<const Light> lights) {
  Thread sum{.u = 0};
  for (const Light& light : lights) {
    if (!(Dot(light.direction, kUp) > 0)) continue;
    sum.u += Luminance(light.irradiance) * Dot(light.direction, kU);
    sum.v += Luminance(light.irradiance) * Dot(light.direction, kV);
  }
  const double length = std::hypot(sum.u, sum.v);
  if (!(length > 0)) return {};
  return {sum.u / length, sum.v / length};
}

}  // namespace

View ViewSphere(int size, int every) {
  CheckImageSize(size);
  CheckNumber("every", every, every >= 1, "1 or more");
  View view{size, size, {}};
  for (int index = 0; index < size * size; ++index) {
    const int row = index / size, column = index % size;
    if ((column + every / 2 * row) % every != 0) continue;
    const double x = (column + 0.5) / size * 2 - 1;
    const double y = 1 - (row + 0.5) / size * 2;
    const double z2 = 1 - x * x - y * y;
    if (!(z2 > 0)) continue;
    const Direction normal = {x, y, std::sqrt(z2)};
    // (0, 1, 0) x normal; no visible pixel's centre is at the poles.
    const double around = std::hypot(normal[0], normal[2]);
    const Direction tangent = {normal[2] / around, 0, -normal[0] / around};
    view.points.push_back({index, tangent, Cross(normal, tangent), normal});
  }
  return view;
}

View ViewCloth(int size, std::span<const Light> lights) {
  CheckImageSize(size);
  const Thread along = AlongLight(lights);
  View view{size, 2 * size, {}};
  for (const Thread& thread : {along, Thread{-along.v, along.u}}) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const double u = (column + 0.5) / size * 2 - 1;
        const Fold fold = FoldAt(u, VAt(u, 1 - (row + 0.5) / size * 2));
        const Direction normal = Normalized(Combined(-fold.u, -fold.v, 1));
        const Direction x =
            Normalized(Combined(thread.u, thread.v, thread.u * fold.u + thread.v * fold.v));
        view.points.push_back({static_cast<int>(view.points.size()), x, Cross(normal, x), normal});
      }
    }
  }
  return view;
}

}  // namespace trilobe
