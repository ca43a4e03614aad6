#ifndef TRILOBE_MODEL_SPLINED_COSINE_H_
#define TRILOBE_MODEL_SPLINED_COSINE_H_

#include <cmath>

#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/stencil.h"

namespace trilobe {

// If G is a spline, so is the cosine, through cos theta_k at the nodes (docs/model.md).
inline double SplinedCosine(const CatmullRom& spline, const Stencil& stencil) {
  double sum = 0;
  for (int k = 0; k < stencil.size; ++k) {
    sum += stencil.weight[k] * std::cos(spline.NodeAngle(stencil.index[k]));
  }
  return sum;
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_SPLINED_COSINE_H_
