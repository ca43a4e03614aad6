#ifndef TRILOBE_SOLVERS_JOINT_CONDENSED_COST_H_
#define TRILOBE_SOLVERS_JOINT_CONDENSED_COST_H_

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>

#include <span>
#include <vector>

#include "solvers/joint/ceres_run.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {

// The sums over all samples for CondensedCost at the point that Ceres is about to evaluate. Each
// point with derivatives becomes the new linearisation point x0.
class CondensedSums : public ceres::EvaluationCallback {
 public:
  // `p` is the parameter block of the problem. With an active set, parameters are held (Held).
  // Adds the time of the factorisation to *phases.
  CondensedSums(const CeresParameters& parameters, std::span<const double> p, bool active_set,
                PhaseSeconds* phases);

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

  int num_parameters() const { return static_cast<int>(p_.size()); }
  // Whether all sums and the factor are finite.
  bool valid() const { return valid_; }
  // E / residual_unit^2 at the last prepared point, with held parameters at their bound.
  double cost() const { return cost_; }
  bool is_linearization() const { return is_linearization_; }  // whether this point is x0

  // At x0, in Ceres' parameters and units: the upper triangular R, R'R = J'J, by rows, with a row
  // of zeros below [n + 1][n], and  [R^-T J'r; sqrt(E - |R^-T J'r|^2)]  [n + 1].
  std::span<const double> R() const { return R_; }
  std::span<const double> residuals() const { return residuals_; }
  std::span<const double> x0() const { return x0_; }

  // The active set: whether a parameter is 0 at x0 and has a positive gradient. Ceres projects a
  // step only after solving for all parameters, so such a parameter would spoil the other steps.
  bool Held(int k) const { return held_[k]; }

  // The model at the last prepared point, and E if it was evaluated there.
  CeresPoint Point() const;

 private:
  FactorModel Model() const;
  void Linearize();
  bool Condense();

  const CeresParameters& parameters_;
  const std::span<const double> p_;
  const bool active_set_;
  PhaseSeconds* const phases_;
  NormalEquations equations_;
  QuadraticModel at_;  // at x0

  bool valid_ = false, is_linearization_ = false;
  double cost_ = 0;
  std::vector<double> valued_;  // the point of the last evaluation of E, and its E
  double value_ = 0;
  std::vector<double> x0_, R_, residuals_;
  std::vector<bool> held_;
};

// The residuals r of an objective condensed to n + 1 residuals of n parameters. With the sums at
// x0,
//   m(x) = [R (x - x0) + R^-T J'r; sqrt(E(x0) - |R^-T J'r|^2)]
// has the length of the linearised residuals r + J (x - x0). The condensed residuals are
//   r^(x) = sqrt(E(x)) m(x) / |m(x)|.
// So |r^|^2 is E everywhere, and J^(x0) = [R; 0], since E and |m|^2 agree in value and gradient at
// x0. Ceres makes the steps that it would make with a residual block for each sample.
class CondensedCost : public ceres::CostFunction {
 public:
  explicit CondensedCost(const CondensedSums* sums);

  // r^ and, at x0, J^, at the prepared point.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const CondensedSums& sums_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_CONDENSED_COST_H_
