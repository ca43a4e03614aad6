#ifndef TRILOBE_SOLVERS_DIAGNOSIS_H_
#define TRILOBE_SOLVERS_DIAGNOSIS_H_

#include <optional>
#include <span>
#include <string>

#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// Diagnosis::optimality: in the scale z_i = x_i |J_i|, g_i = (J'r)_i / |J_i|, the largest component
// of the step z - max(0, z - g) of projected steepest descent, over |r|. It does not depend on the
// gauge, since scaling a parameter scales its column of J inversely.
double ScaledProjectedGradient(const QuadraticModel& at, std::span<const double> x);

// All of a Diagnosis: one pass over the data and one eigenvalue decomposition of J'J.
Diagnosis Diagnose(const Objective& objective, const FactorModel& model);

// A sentence for the user where directions are so weak, within a factor of 10 of rank_tolerance or
// below it, that normal equations do not determine them (docs/solvers.md); with the reason, where
// that is too many bins of F.
std::optional<std::string> ConditionWarning(const Objective& objective, const Diagnosis& diagnosis);

// How many directions of the F tables change no value of the data whatever D and G are: of F's bins
// that scattered samples read, those beyond what the samples' theta_d can tell. 0 on a grid.
int UndeterminedByThetaD(const Objective& objective);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_DIAGNOSIS_H_
