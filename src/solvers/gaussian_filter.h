#ifndef TRILOBE_SOLVERS_GAUSSIAN_FILTER_H_
#define TRILOBE_SOLVERS_GAUSSIAN_FILTER_H_

#include <span>

#include "trilobe/model/factor_model.h"

namespace trilobe {

// Smooths every G table with a Gaussian of standard deviation `sigma` nodes, cut at 3 sigma, over
// its observed nodes only (coverage > 0; weights are renormalised at ends and gaps). It suppresses
// oscillations of G on specular materials and may raise E (paper 3.3, docs/sums.md). coverage:
// Objective::coverage(). Throws Error for a coverage of another size, an anisotropic model, and
// sigma <= 0.
void SmoothG(double sigma, std::span<const double> coverage, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_GAUSSIAN_FILTER_H_
