#ifndef TRILOBE_APPEARANCE_MIRRORED_ENVIRONMENT_H_
#define TRILOBE_APPEARANCE_MIRRORED_ENVIRONMENT_H_

#include <vector>

#include "trilobe/appearance/environment.h"
#include "trilobe/geometry/channels.h"
#include "trilobe/geometry/directions.h"

namespace trilobe {

// An environment as the eye (kEye, +z) sees it in mirrors: by the normal h of the mirror, which
// reflects the light from l = 2 (h z) h - z. (h_x, h_y) is a map of all l, a disc, that keeps
// areas: d omega_l = 4 h_z d omega_h = 4 dh_x dh_y. So its pixels, and their means over 2 x 2, 4 x
// 4, ... of them, each stand for the same solid angle.
class MirroredEnvironment {
 public:
  // Throws Error as CheckEnvironment does.
  explicit MirroredEnvironment(const Environment& environment);

  // The mean radiance of what mirrors reflect whose normals are within a solid angle [sr] around
  // `half`, above the eye's horizon.
  Rgb Mean(const Direction& half, double solid_angle) const;

 private:
  // The channels, in the lanes of a vector.
  struct alignas(4 * sizeof(double)) Pixel {
    double lane[kChannels + 1] = {};
  };
  struct Level {
    int size = 0;
    std::vector<Pixel> radiance;  // [size * size]
    // Adds `share` of it to *sum.
    void AddAt(double x, double y, double share, Pixel* sum) const;
  };
  std::vector<Level> levels_;  // finest first
};

// A piece of the half vectors about a normal, which is z here.
struct HalfCell {
  Direction half{};
  double theta = 0, sine = 0;  // from the normal [rad]
  double solid_angle = 0;      // [sr]
};

// All half vectors in rings, narrow where highlights are, theta_h being in proportion to the power
// 5/2 of a ring's number, and cut into a few cells each: what a picture of a material of any gloss
// is summed over.
const std::vector<HalfCell>& HalfCells();

}  // namespace trilobe

#endif  // TRILOBE_APPEARANCE_MIRRORED_ENVIRONMENT_H_
