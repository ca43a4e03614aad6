#ifndef TRILOBE_SOLVERS_CERES_CERES_RUN_H_
#define TRILOBE_SOLVERS_CERES_CERES_RUN_H_

#include <functional>
#include <optional>
#include <span>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/run.h"

namespace ceres {
class Problem;
}  // namespace ceres

namespace trilobe {

// A model's parameters x as Ceres sees them. d and s are measured in the power of two next to the
// weighted root mean square of the data, and residuals in that next to theirs at a black model,
// since Ceres' scaling of columns and its damping contain absolute constants. x >= 0 is kept by
// bounds.
class CeresParameters {
 public:
  // Whether the cost function holds parameters on their bounds (IsHeld).
  enum class ActiveSet { kNone, kInCost };

  // Ceres itself has no active set: where the run's options ask for one and the cost has none,
  // there are bounds alone and a note says so.
  CeresParameters(const Objective& objective, FactorModel start, ActiveSet active_set, Run* run);

  double value_unit() const { return value_unit_; }        // of d and s
  double residual_unit() const { return residual_unit_; }  // E becomes E / residual_unit^2

  // True for a parameter that is 0 and that a lower E would push below, with dE/dx given, where
  // there is an active set. As Ceres would project its step only after it is made for all
  // parameters together, such a parameter spoils the steps of the others: it is to have no
  // derivative.
  bool IsHeld(double p, double gradient) const { return holds_ && p <= 0 && gradient > 0; }

  // The starting point in Ceres' parameters, each in the place of the model's.
  FactorModel Start() const;
  // The model of such parameters. Unobserved bins are the starting point's, to the last bit.
  FactorModel Model(FactorModel p) const;
  // 0 <= x <= kMaxParameter, or the start if that is above, for a block of the problem that holds
  // such parameters of the starting point.
  void SetBounds(std::span<double> block, ceres::Problem* problem) const;

 private:
  FactorModel Scaled(FactorModel model, double by) const;  // d and s times `by`

  const Objective& objective_;
  const FactorModel start_;
  const double value_unit_, residual_unit_;
  const bool holds_;
};

// How Ceres solves the linear least-squares problem of a step: by a Cholesky factorisation of the
// normal equations, SuiteSparse's or a dense one, or by a QR factorisation of the Jacobian, which
// does not square its condition number. The dense ones store the whole Jacobian.
enum class CeresLinearSolver { kSparseCholesky, kDenseCholesky, kDenseQr };

// Where Ceres stands, and E there if it is known.
struct CeresPoint {
  FactorModel model;
  std::optional<double> objective = std::nullopt;
};

// Makes the iterations of a run that Run::Start has begun by Ceres' trust-region minimizer, with
// `num_threads` threads, or this one alone where the system gives no more, from where the problem's
// parameter blocks stand. The problem's cost is to be E up to a constant factor. `current` makes a
// model of the blocks, which are up to date when it is called; the run records it after each
// iteration of Ceres, those among them whose step was taken back. The run's trust_region option is
// honoured, and its stopping test is the only one; where Ceres can go no further before, it is
// kNoDecrease, with Ceres' reason in a note. Adds Ceres' times to the run's phases.
void MinimizeWithCeres(CeresLinearSolver linear_solver, int num_threads,
                       const std::function<CeresPoint()>& current, ceres::Problem* problem,
                       Run* run);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_CERES_CERES_RUN_H_
