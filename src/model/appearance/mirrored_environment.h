#ifndef TRILOBE_MODEL_APPEARANCE_MIRRORED_ENVIRONMENT_H_
#define TRILOBE_MODEL_APPEARANCE_MIRRORED_ENVIRONMENT_H_

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/lanes.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/appearance/environment.h"

namespace trilobe {

// The channels, and a fourth value that is summed with them, in the lanes of a vector.
struct alignas(4 * sizeof(double)) Pixel {
  double lane[kChannels + 1] = {};
};

// An environment as the eye (kEye, +z) sees it in mirrors with normal h, which reflect the light
// from l = 2 (h z) h - z. (h_x, h_y) maps all l to a disc and preserves areas: d omega_l = 4 h_z d
// omega_h = 4 dh_x dh_y. So all pixels, and all means over 2 x 2, 4 x 4, ... of them, have the same
// solid angle.
class MirroredEnvironment {
 public:
  // Throws Error as CheckEnvironment does.
  explicit MirroredEnvironment(const Environment& environment);

  // The mean radiance reflected by mirrors whose normals are within a solid angle [sr] around
  // `half`, above the eye's horizon.
  Rgb Mean(const Direction& half, double solid_angle) const;

  // The same with its luminance, for `half` rotated about the eye by 0, 1, ... quarter turns from x
  // towards y.
  template <int kTurns>
  void SetMeans(const Direction& half, double solid_angle, Four<double>* means) const;

 private:
  struct Level {
    int size = 0;
    std::vector<Pixel> radiance;  // [size * size]
    template <int kTurns>
    void AddAt(double x, double y, double share, Four<double>* sums) const;
  };
  std::vector<Level> levels_;  // finest first
  double finest_pixels_ = 0;   // the side of a square as wide as a mean over the area 1, in pixels
};

// Bilinear between pixel centres; x and y from -1 to 1. A quarter turn maps the row to the column,
// and the column to the reversed row; so the corners of the square around (x, y) keep their
// weights, and the first one becomes the last.
template <int kTurns>
TRILOBE_ALWAYS_INLINE void MirroredEnvironment::Level::AddAt(double x, double y, double share,
                                                             Four<double>* sums) const {
  const double column = std::clamp((x + 1) / 2 * size - 0.5, 0.0, size - 1.0);
  const double row = std::clamp((1 - y) / 2 * size - 0.5, 0.0, size - 1.0);
  const int last = size - 2;  // a square begins there or before
  const int c = std::min(static_cast<int>(column), last);
  const int r = std::min(static_cast<int>(row), last);
  const double s = column - c, t = row - r;
  // Weights of the corners, clockwise from the upper left.
  const double weights[] = {share * (1 - t) * (1 - s), share * (1 - t) * s, share * t * s,
                            share * t * (1 - s)};
  const int squares[] = {r * size + c, (last - c) * size + r, (last - r) * size + last - c,
                         c * size + last - r};
  for (int turn = 0; turn < kTurns; ++turn) {
    const Pixel* const above = &radiance[squares[turn]];
    const Pixel* const below = above + size;
    const auto weight = [&](int corner) __attribute__((always_inline)) {
      return weights[(corner + turn) % 4];
    };
    sums[turn] += (weight(0) * Load(above[0].lane) + weight(1) * Load(above[1].lane)) +
                  (weight(3) * Load(below[0].lane) + weight(2) * Load(below[1].lane));
  }
}

template <int kTurns>
TRILOBE_ALWAYS_INLINE void MirroredEnvironment::SetMeans(const Direction& half, double solid_angle,
                                                         Four<double>* means) const {
  const double area = std::max(half[2] * solid_angle, 1e-12);
  const double level = std::clamp(std::log2(finest_pixels_ * finest_pixels_ * area) / 2, 0.0,
                                  static_cast<double>(levels_.size() - 1));
  const int finer = std::min(static_cast<int>(level), static_cast<int>(levels_.size()) - 2);
  const double t = level - finer;
  for (int turn = 0; turn < kTurns; ++turn) means[turn] = Four<double>{};
  levels_[finer].AddAt<kTurns>(half[0], half[1], 1 - t, means);
  levels_[finer + 1].AddAt<kTurns>(half[0], half[1], t, means);
}

// A cell of half vectors about a normal, here z.
struct HalfCell {
  Direction half{};
  double theta = 0, sine = 0;  // from the normal [rad]
  double solid_angle = 0;      // [sr]

  // `half` about another normal, by the smallest rotation from z to it; continuous where the eye
  // looks.
  Direction HalfVectorAbout(const Direction& n) const {
    const double along = (n[0] * half[0] + n[1] * half[1]) / (1 + n[2]);
    return {half[0] - n[0] * along + n[0] * half[2], half[1] - n[1] * along + n[1] * half[2],
            n[2] * half[2] - n[0] * half[0] - n[1] * half[1]};
  }
};

// The direction from which a mirror reflects light to the eye.
inline Direction MirroredEye(const Direction& half) {
  return {2 * half[2] * half[0], 2 * half[2] * half[1], 2 * half[2] * half[2] - 1};
}

// All half vectors in rings, which are narrow in highlights (theta_h is proportional to the power
// 5/2 of a ring's number) and divided into a few cells each. Images of a material of any gloss are
// sums over them. A quarter turn about the normal maps the cells to themselves.
const std::vector<HalfCell>& HalfCells();

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_MIRRORED_ENVIRONMENT_H_
