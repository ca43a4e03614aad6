#ifndef TRILOBE_MODEL_APPEARANCE_ENVIRONMENT_H_
#define TRILOBE_MODEL_APPEARANCE_ENVIRONMENT_H_

#include <string>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"

namespace trilobe {

// Light from everywhere, by direction, as a picture in latitude and longitude. The world: x to the
// right, y up, z towards the eye. Rows go from +y down to -y; columns go around, the middle one
// behind the object (-z), as a camera in its place would see it.
struct Environment {
  std::string name;
  int width = 0, height = 0;
  std::vector<Rgb> radiance;  // [height * width], row by row, >= 0 and finite
};

// Throws Error unless it is as said above, and of one pixel or more.
void CheckEnvironment(const Environment& environment);

// A fixed one, for when no probe is given: a sky brighter towards the horizon, dark ground, a sun,
// and three area lights of different colours.
const Environment& StudioEnvironment();

// A light so far away that its rays are parallel.
struct Light {
  Direction direction;  // towards it, in the world
  Rgb irradiance;       // on a surface that faces it
};

// `count` lights of equal luminance that stand for the environment: the points of a Hammersley set,
// drawn in proportion to luminance. Deterministic. Throws Error for an environment that is none or
// black, and for fewer lights than one.
std::vector<Light> DrawLights(const Environment& environment, int count);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_ENVIRONMENT_H_
