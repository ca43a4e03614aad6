#ifndef TRILOBE_LOBES_CONTINUOUS_MODEL_H_
#define TRILOBE_LOBES_CONTINUOUS_MODEL_H_

#include <span>
#include <vector>

#include "trilobe/geometry/channels.h"
#include "trilobe/geometry/directions.h"
#include "trilobe/math/catmull_rom.h"
#include "trilobe/math/stencil.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// A model as a function of directions, prepared for many calls: the splines through G and the
// cosines are turned into cubics, so that a call costs two arc cosines and two cubics a G table.
// The same value as EvaluateAt(model, ScatteredStencils(...)), to rounding, and so never negative.
class ContinuousModel {
 public:
  // Keeps a reference to `model`, which must outlive it. Throws Error for an anisotropic one.
  explicit ContinuousModel(const FactorModel& model);

  // BRDF [1/sr] where D, by the number of the stretch, and F are read through these stencils.
  // Cosines in (0, 1].
  Rgb operator()(std::span<const Stencil> D, const Stencil& F, const Cosines& cosines) const;

  // The same without the bound: what E compares with the measurement (UnclampedValue).
  Rgb Unclamped(std::span<const Stencil> D, const Stencil& F, const Cosines& cosines) const;

  // D and F linear between bin centres. `cosines` are those of `angles`.
  Rgb operator()(const HalfDiffAngles& angles, const Cosines& cosines) const;
  Rgb Unclamped(const HalfDiffAngles& angles, const Cosines& cosines) const;

  // 0 where a direction is below the surface.
  Rgb operator()(const DirectionPair& directions) const;

 private:
  const FactorModel& model_;
  MerlGrid grid_;  // whose bins D and F are
  CatmullRom spline_;
  std::vector<CatmullRom::Piece> cosine_;          // [interval]
  std::vector<std::vector<CatmullRom::Piece>> g_;  // [G table][interval]
};

}  // namespace trilobe

#endif  // TRILOBE_LOBES_CONTINUOUS_MODEL_H_
