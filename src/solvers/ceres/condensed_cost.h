#ifndef TRILOBE_SOLVERS_CERES_CONDENSED_COST_H_
#define TRILOBE_SOLVERS_CERES_CONDENSED_COST_H_

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>

#include <span>
#include <vector>

#include "solvers/ceres/ceres_run.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {

// The sums over all samples that CondensedCost is made of, at the point that Ceres is about to
// evaluate. Wherever Ceres wants derivatives the problem is linearised: x0 is moved there.
class CondensedSums : public ceres::EvaluationCallback {
 public:
  // `p`, the user's parameter block, holds Ceres' parameters at each call. With an active set,
  // parameters are held (Held). Times of the factorisation go to *phases.
  CondensedSums(const CeresParameters& parameters, std::span<const double> p, bool active_set,
                PhaseSeconds* phases);

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

  int num_parameters() const { return static_cast<int>(p_.size()); }
  // False where a sum or the factor is not finite.
  bool valid() const { return valid_; }
  // E / residual_unit^2 at the point that was last prepared, with what is held at its bound.
  double cost() const { return cost_; }
  bool is_linearization() const { return is_linearization_; }  // whether that point is x0

  // At x0, in Ceres' parameters and units: the upper triangular R, R'R = J'J, by rows, with a row
  // of zeros below [n + 1][n], and  [R^-T J'r; sqrt(E - |R^-T J'r|^2)]  [n + 1].
  std::span<const double> R() const { return R_; }
  std::span<const double> residuals() const { return residuals_; }
  std::span<const double> x0() const { return x0_; }

  // The active set: a parameter that is 0 at x0, and that a lower E would push below. As Ceres
  // would project its step only after it is made for all parameters together, such a parameter
  // would spoil the steps of the others.
  bool Held(int k) const { return held_[k]; }

  // The model at the point that was last prepared, and E if it was computed there by itself.
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
  std::vector<double> valued_;  // where E was computed last by itself, and E there
  double value_ = 0;
  std::vector<double> x0_, R_, residuals_;
  std::vector<bool> held_;
};

// All residuals r of an objective as n + 1 numbers in n parameters. With the sums at x0,
//   m(x) = [R (x - x0) + R^-T J'r; sqrt(E(x0) - |R^-T J'r|^2)]
// is as long as r + J (x - x0), the linearised residuals. This is m, stretched to the length of r:
//   r^(x) = sqrt(E(x)) m(x) / |m(x)|.
// So |r^|^2 is E everywhere; and as E and |m|^2 agree in value and gradient at x0, J^(x0) = [R; 0].
// Hence Ceres makes the steps that it would make with a residual block for each sample.
class CondensedCost : public ceres::CostFunction {
 public:
  explicit CondensedCost(const CondensedSums* sums);

  // r^ and, at x0, J^, at the point for which the sums are prepared.
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const CondensedSums& sums_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_CERES_CONDENSED_COST_H_
