#ifndef TRILOBE_SOLVERS_DIAGNOSIS_H_
#define TRILOBE_SOLVERS_DIAGNOSIS_H_

#include <optional>
#include <span>
#include <string>

#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// Diagnosis::optimality: in the scale z_i = x_i |J_i|, g_i = (J'r)_i / |J_i|, the largest component
// of the projected steepest descent step z - max(0, z - g), over |r|. It does not depend on the
// gauge, since scaling a parameter scales its column of J inversely.
double ScaledProjectedGradient(const QuadraticModel& at, std::span<const double> x);

// Computes a Diagnosis by one pass over the data and one eigenvalue decomposition of J'J.
Diagnosis Diagnose(const Objective& objective, const FactorModel& model);

// A warning for the user if singular values are below 10 rank_tolerance, so that normal equations
// do not determine their directions (docs/solvers.md). Names the reason if F has too many bins.
std::optional<std::string> ConditionWarning(const Objective& objective, const Diagnosis& diagnosis);

// Number of directions of the F tables that change no value of the data, whatever D and G are,
// because the theta_d of scattered samples do not resolve the bins of F. 0 on a grid.
int UndeterminedByThetaD(const Objective& objective);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_DIAGNOSIS_H_
