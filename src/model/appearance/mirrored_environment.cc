#include "model/appearance/mirrored_environment.h"

#include <algorithm>
#include <cmath>

#include "model/appearance/color.h"

namespace trilobe {
namespace {

constexpr int kSize = 512;       // pixels across the finest map
constexpr int kSamples = 2;      // of the environment along each side of a pixel
constexpr int kRings = 26;       // of half vectors
constexpr double kAspect = 1.5;  // of a cell: along its ring over across it
// Side of the square over which a cell is averaged, relative to a square of the cell's area. With
// less, lamps show as spots; with more, light leaks over the horizon.
constexpr double kBlur = 1.8;

// The environment in the light's direction, nearest pixel. Beyond the rim of the disc, which is the
// direction behind the object, the map continues on the opposite side.
const Rgb& Reflected(const Environment& environment, double x, double y) {
  const double radius = std::hypot(x, y);
  if (radius > 1) {
    const double inside = (radius - 2) / radius;  // on the other side
    x *= inside;
    y *= inside;
  }
  const double z2 = std::max(1 - x * x - y * y, 0.0), z = std::sqrt(z2);
  const Direction light = {2 * z * x, 2 * z * y, 2 * z2 - 1};
  const double row = std::acos(std::clamp(light[1], -1.0, 1.0)) / kPi * environment.height;
  const double column = (std::atan2(light[0], -light[2]) / (2 * kPi) + 0.5) * environment.width;
  return environment
      .radiance[std::min(static_cast<int>(row), environment.height - 1) * environment.width +
                std::min(static_cast<int>(column), environment.width - 1)];
}

std::vector<HalfCell> MakeCells() {
  // Polar angle of the edge of a ring [rad].
  const auto theta = [](double ring) { return kPi / 2 * std::pow(ring / kRings, 2.5); };
  std::vector<HalfCell> cells;
  for (int ring = 0; ring < kRings; ++ring) {
    const double inner = theta(ring), outer = theta(ring + 1), middle = theta(ring + 0.5);
    const double quarter = kPi / 2 * std::sin(middle) / (outer - inner) / kAspect;
    const int around = 4 * std::max(2, static_cast<int>(std::lround(quarter)));
    const double solid_angle = 2 * kPi * (std::cos(inner) - std::cos(outer)) / around;
    for (int k = 0; k < around; ++k) {
      // Turned by the golden angle from ring to ring, so that no spokes are seen.
      const double phi = 2 * kPi * k / around + ring * kPi * (3 - std::sqrt(5.0));
      cells.push_back({ToDirection({middle, phi}), middle, std::sin(middle), solid_angle});
    }
  }
  return cells;
}

}  // namespace

MirroredEnvironment::MirroredEnvironment(const Environment& environment)
    : finest_pixels_(kBlur * kSize / 2) {
  CheckEnvironment(environment);
  Level finest{kSize, {}};
  for (int row = 0; row < kSize; ++row) {
    for (int column = 0; column < kSize; ++column) {
      Pixel sum;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const int line = k / kSamples;
        const double x = column + (k % kSamples + 0.5) / kSamples;
        const double y = row + (line + 0.5) / kSamples;
        const Rgb& seen = Reflected(environment, 2 * x / kSize - 1, 1 - 2 * y / kSize);
        const double lanes[] = {seen[0], seen[1], seen[2], Luminance(seen)};
        for (int c = 0; c < 4; ++c) sum.lane[c] += lanes[c] / (kSamples * kSamples);
      }
      finest.radiance.push_back(sum);
    }
  }
  levels_.push_back(std::move(finest));
  while (levels_.back().size > 2) {
    const Level& fine = levels_.back();
    Level coarse{fine.size / 2, {}};
    for (int row = 0; row < coarse.size; ++row) {
      for (int column = 0; column < coarse.size; ++column) {
        Pixel mean;
        for (int k = 0; k < 4; ++k) {
          const Pixel& part = fine.radiance[(2 * row + k / 2) * fine.size + 2 * column + k % 2];
          for (int c = 0; c < 4; ++c) mean.lane[c] += part.lane[c] / 4;
        }
        coarse.radiance.push_back(mean);
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

Rgb MirroredEnvironment::Mean(const Direction& half, double solid_angle) const {
  Four<double> mean;
  SetMeans<1>(half, solid_angle, &mean);
  return {mean[0], mean[1], mean[2]};
}

const std::vector<HalfCell>& HalfCells() {
  static const std::vector<HalfCell> cells = MakeCells();
  return cells;
}

}  // namespace trilobe
