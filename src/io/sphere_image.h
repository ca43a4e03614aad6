#ifndef TRILOBE_IO_SPHERE_IMAGE_H_
#define TRILOBE_IO_SPHERE_IMAGE_H_

#include <vector>

#include "trilobe/model/brdf_table.h"
#include "trilobe/model/channels.h"

namespace trilobe {

// Radiance of a sphere seen from afar, lit by three distant lights: a key light from the upper left
// (irradiance pi across its beam), a fill light from the right, and a rim light from behind, which
// shows the material at grazing angles. No shadows, no light from elsewhere, linear colours.
struct SphereImage {
  // Samples a pixel, along each side, so that edges can be smoothed after tone mapping.
  static constexpr int kSamples = 2;

  int size = 0;                 // pixels along each side
  std::vector<Rgb> radiance;    // [(size kSamples)^2], row by row from the top; 0 off the sphere
  std::vector<bool> on_sphere;  // like radiance
};

// The same for any number of threads. `size` is in pixels. Throws Error when no bin is valid.
SphereImage RenderSphere(const BrdfTable& material, int size, int num_threads);

// Luminance of linear sRGB colours (ITU-R BT.709).
double Luminance(const Rgb& color);

// The sRGB curve (IEC 61966-2-1), input clipped to [0, 1]; in and out.
double EncodeSrgb(double linear);

}  // namespace trilobe

#endif  // TRILOBE_IO_SPHERE_IMAGE_H_
