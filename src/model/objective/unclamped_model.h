#ifndef TRILOBE_MODEL_OBJECTIVE_UNCLAMPED_MODEL_H_
#define TRILOBE_MODEL_OBJECTIVE_UNCLAMPED_MODEL_H_

#include <span>
#include <vector>

#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/stencil.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The value of an isotropic model without clamping at 0, at angles or grid bins, as E compares it
// with a measurement (UnclampedValue), prepared for many calls. PreparedModel has clamped values
// only.
class UnclampedModel {
 public:
  // Keeps a reference to `model`, which must outlive it. Throws Error for an anisotropic one.
  explicit UnclampedModel(const FactorModel& model);

  // The value [1/sr] from stencils of F and, for each distinct stretch, of D. Cosines in (0, 1].
  Rgb operator()(std::span<const Stencil> D, const Stencil& F, const Cosines& cosines) const;

  // D and F linear between bin centres. `cosines` are those of `angles`.
  Rgb operator()(const HalfDiffAngles& angles, const Cosines& cosines) const;

 private:
  const FactorModel& model_;
  MerlGrid grid_;  // whose bins D and F are
  CatmullRom spline_;
  std::vector<CatmullRom::Piece> cosine_;          // [interval]
  std::vector<std::vector<CatmullRom::Piece>> g_;  // [G table][interval]
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_UNCLAMPED_MODEL_H_
