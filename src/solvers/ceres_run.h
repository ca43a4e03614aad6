#ifndef TRILOBE_SOLVERS_CERES_RUN_H_
#define TRILOBE_SOLVERS_CERES_RUN_H_

#include <functional>

#include "trilobe/model/factor_model.h"
#include "trilobe/solvers/run.h"

namespace ceres {
class Problem;
}  // namespace ceres

namespace trilobe {

// The power of two next to the root mean square of the weighted data. Residuals are measured in
// it, because Ceres' scaling of columns and damping contain absolute constants.
double CeresUnit(const Objective& objective);

// The model in other units: d and s times `by`.
FactorModel Scaled(FactorModel model, double by);

// How Ceres solves the normal equations of a step: by SuiteSparse's sparse Cholesky factorisation,
// or by a dense one, for which Ceres stores the whole Jacobian.
enum class CeresLinearSolver { kSparse, kDense };

// Makes the iterations of a run that Run::Start has begun by Ceres' trust-region minimizer, with
// `num_threads` threads, from where the problem's parameter blocks stand. The problem's cost is to
// be E up to a constant factor. `current_model` makes a model of the blocks, which are up to date
// when it is called; the run records it after each iteration of Ceres, those among them whose step
// was taken back. The run's trust_region option is honoured, and its stopping test is the only one;
// where Ceres can go no further before, it is kNoDecrease, with Ceres' reason in a note. Adds
// Ceres' times to the run's phases.
void MinimizeWithCeres(CeresLinearSolver linear_solver, int num_threads,
                       const std::function<FactorModel()>& current_model, ceres::Problem* problem,
                       Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_CERES_RUN_H_
