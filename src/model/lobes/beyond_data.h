#ifndef TRILOBE_MODEL_LOBES_BEYOND_DATA_H_
#define TRILOBE_MODEL_LOBES_BEYOND_DATA_H_

#include <span>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// Entries of tables that no data touch (coverage 0) are no parameters; they follow from the
// observed ones, and say what the model is where nothing was measured. `coverage` is
// Objective::coverage(), in the order of model->parameters(); both throw Error if it has another
// size. A table without any observed entry stays as it is.

// Linearly between two observed entries, and as the last one beyond it; for work inside a fit.
void FillFromNeighbors(std::span<const double> coverage, FactorModel* model);

// The same for a model that is to be looked at: beyond the last observed entry the median of the
// last five. Of G it is G / cos theta that is continued so, since that keeps the BRDF from growing
// towards the horizon, and rings of nodes beyond the last two observed ones have
// G / cos theta = 1 / (a + b cos theta) through these. Of D, where it is a table over theta_h
// alone, what its lobe reflects per half vector stays below the median of the last five, too. The
// same bits for any number of threads.
void ContinueBeyondData(std::span<const double> coverage, int num_threads, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_BEYOND_DATA_H_
