#ifndef TRILOBE_MODEL_APPEARANCE_ENVIRONMENT_H_
#define TRILOBE_MODEL_APPEARANCE_ENVIRONMENT_H_

#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// Incident radiance by direction, as a latitude-longitude image. World: x right, y up, z towards
// the eye. Rows run from +y to -y; the middle column is behind the object (-z), as seen by a camera
// in its place.
struct Environment {
  std::string name;
  int width = 0, height = 0;
  std::vector<Rgb> radiance;  // [height * width], row by row, >= 0 and finite
};

// Throws Error unless the environment is as described above, with at least one pixel.
void CheckEnvironment(const Environment& environment);

// The default environment: a sky that is brighter towards the horizon, dark ground, a sun, and
// three area lights of different colours.
const Environment& StudioEnvironment();

// A directional light.
struct Light {
  Direction direction;  // towards it, in the world
  Rgb irradiance;       // on a surface that faces it
};

// Approximates the environment by `count` lights of equal luminance at a Hammersley set,
// distributed in proportion to luminance. Deterministic. Throws Error for an invalid or black
// environment and for count < 1.
std::vector<Light> DrawLights(const Environment& environment, int count);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_ENVIRONMENT_H_
