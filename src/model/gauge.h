#ifndef TRILOBE_MODEL_GAUGE_H_
#define TRILOBE_MODEL_GAUGE_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// Scale can move between s, D, F and G without changing any BRDF value. The canonical form fixes it
// (docs/method.md), which makes models storable and lobes comparable:
// - each D integrates to 1 over the projected hemisphere: sum_i D_i pi (sin^2 b_{i+1} - sin^2 b_i)
//   = 1 with the true edges b_i of the theta_h bins;
// - each F and each G has mean 1, weighted by `coverage`, over the bins that data touch;
// - s carries the magnitude. A lobe whose factors vanish gets s = 0, its vanished tables 1
//   everywhere before normalisation.
// Dead bins (coverage 0) are filled for display first, from their nearest live neighbours: linearly
// between two, constant beyond the last.
// `coverage` is Objective::coverage(), in the order of model->parameters().
void Canonicalize(std::span<const double> coverage, FactorModel* model);

// Integral of D over the projected hemisphere, D constant in each bin.
double ProjectedIntegral(std::span<const double> D);

// Makes the parameters of `to` that no data touch those of `from`, a model of the same spec.
void CopyDeadParameters(std::span<const double> coverage, const FactorModel& from, FactorModel* to);

// True for the table entries that no data touch, in the order of parameters().
std::vector<bool> DeadParameters(std::span<const double> coverage);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_GAUGE_H_
