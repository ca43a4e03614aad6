#ifndef TRILOBE_MODEL_APPEARANCE_VIEW_H_
#define TRILOBE_MODEL_APPEARANCE_VIEW_H_

#include <span>
#include <vector>

#include "trilobe/core/base/directions.h"
#include "trilobe/model/appearance/environment.h"

namespace trilobe {

// The towards-eye direction of all views, in the world (environment.h).
inline constexpr Direction kEye = {0, 0, 1};

// The point of an object that a pixel sees: orthonormal vectors, `x` and `y` along those of the
// material.
struct SurfacePoint {
  int pixel = 0;
  Direction x{}, y{}, normal{};
};

// An object seen from afar: the points of its surface at pixel centres.
struct View {
  int width = 0, height = 0;  // pixels, row by row from the top
  std::vector<SurfacePoint> points;
};

// A sphere that touches the sides of a square, x along its parallels, to the right. Contains one of
// `every` pixels, evenly spread.
View ViewSphere(int size, int every = 1);

// A piece of cloth that leans back, in soft folds, and fills two squares, one above the other. The
// thread, x, runs along the light in the upper one and across it in the lower; the light's
// direction is the mean of the lights that are above the cloth, as it lies without folds.
View ViewCloth(int size, std::span<const Light> lights);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_VIEW_H_
