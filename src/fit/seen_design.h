#ifndef TRILOBE_FIT_SEEN_DESIGN_H_
#define TRILOBE_FIT_SEEN_DESIGN_H_

#include <span>

#include "fit/greedy_design.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/fit/fit.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// The design that says which of these directions tell most of the sphere that is seen of an
// isotropic fit. About the fit its parameters are taken as linear, with the covariance
//   (J'J / s^2 + R)^-1
// where J'J is that of the samples and of the prior, s^2 the mean square of a weighted residual (of
// 2 % of the values at least), and R keeps each parameter within a third of itself or of a tenth of
// its table's mean: they stay above 0, and what no sample reads is not free. A direction is
// expected to have the fit's value, and weighs as the fit would weigh it. What is seen is CIELAB of
// a sphere's pixels. Each counts by 1 / (2 sigma), sigma^2 the variance of its colour now: the
// derivative by it of sigma, of which the mean Delta E is made.
GreedyDesign SeenDesign(const FitProblem& problem, const FactorModel& model,
                        std::span<const SphericalAngles> directions,
                        const AppearanceOptions& appearance);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SEEN_DESIGN_H_
