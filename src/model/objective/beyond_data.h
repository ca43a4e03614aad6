#ifndef TRILOBE_MODEL_OBJECTIVE_BEYOND_DATA_H_
#define TRILOBE_MODEL_OBJECTIVE_BEYOND_DATA_H_

#include <span>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// Unobserved table entries (coverage 0) are not fitted; they are extrapolated from observed ones
// and define the model outside the data. `coverage` is Objective::coverage(), in the order of
// model->parameters(); both functions throw Error if its size differs. A table without observed
// entries is unchanged.

// Whether enough samples read an entry of a table over theta alone: a twentieth of what the third
// entry inwards has. The first three are.
inline bool IsWellCovered(std::span<const double> coverage, int entry) {
  constexpr double kShare = 0.05;
  constexpr int kInwards = 3;
  return entry < kInwards || coverage[entry] >= kShare * coverage[entry - kInwards];
}

// Linear between observed entries, constant beyond the last; for use inside a fit.
void FillFromNeighbors(std::span<const double> coverage, FactorModel* model);

// The same for a final model. Beyond the last observed entry, log F and log(G / cos theta) over
// theta alone go on as over the last ten that are well covered, and level off (LevelledOff); edge
// entries that hardly a sample reads have no say. Where F falls as G rises along a highlight, both
// go on, and so does what they reflect together. D over theta_h alone is the median of the last
// five, but the light that its lobe reflects per half vector stays below the median of the last
// five, too. Rings beyond the last two observed ones have G / cos theta = 1 / (a + b cos theta)
// through these. The same bits for any number of threads.
void ContinueBeyondData(std::span<const double> coverage, int num_threads, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_BEYOND_DATA_H_
