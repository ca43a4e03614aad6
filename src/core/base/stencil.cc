#include "trilobe/core/base/stencil.h"

#include <algorithm>
#include <cmath>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {

Between OnCircle(double radians, int count) {
  if (!std::isfinite(radians)) {
    throw Error(ErrorKind::kRange, "a direction or an angle is not a finite number")
        .About("radians", radians);
  }
  CheckNumber("the number of steps around a circle", count, count >= 1, "1 or more");
  const double turns = radians / (2 * kPi);
  const double place = (turns - std::floor(turns)) * count;
  const double floor = std::floor(place);
  const int below = static_cast<int>(floor);
  const int lower = below < count ? below : 0;  // where the angle is next to a whole turn
  return {lower, lower + 1 < count ? lower + 1 : 0, place - floor};
}

Stencil PointStencil(int index) { return {1, {index}, {1.0}}; }

Stencil LinearStencil(double coordinate, int bins) {
  if (std::isnan(coordinate)) {
    throw Error(ErrorKind::kRange, "a direction or an angle is not a number")
        .About("coordinate", coordinate);
  }
  CheckNumber("the number of bins", bins, bins >= 2, "2 or more");
  const double x = std::clamp(coordinate - 0.5, 0.0, bins - 1.0);
  const int i = std::min(static_cast<int>(x), bins - 2);
  const double t = x - i;
  if (t < kAtEntry) return PointStencil(i);
  if (t > 1 - kAtEntry) return PointStencil(i + 1);
  return {2, {i, i + 1}, {1 - t, t}};
}

}  // namespace trilobe
