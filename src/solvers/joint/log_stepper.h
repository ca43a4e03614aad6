#ifndef TRILOBE_SOLVERS_JOINT_LOG_STEPPER_H_
#define TRILOBE_SOLVERS_JOINT_LOG_STEPPER_H_

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {

// A term minimised in addition to E.
class AddedTerm {
 public:
  virtual ~AddedTerm() = default;

  virtual double operator()(const FactorModel& model) const = 0;
  // Adds the term to *at, the quadratic model of E at `model` in all its parameters.
  virtual void AddTo(const FactorModel& model, QuadraticModel* at) const = 0;
};

// Roughness of the tables of a model: squared second differences of the logarithms y, plus `slope`
// times squared first differences. On the MERL grid
//   R(y) = sum_tables sum_k (y_k-1 - 2 y_k + y_k+1)^2 + slope sum_k (y_k+1 - y_k)^2.
// R does not depend on scale; without slope, a constant decay costs nothing. On other nodes it uses
// divided differences weighted by the width around k, so that R is the integral of the squared
// second derivative over theta in degrees, for D over 90 sqrt(theta / 90 degrees). For tables over
// azimuths it is the mean of this over phi plus the mean over theta of the same along phi,
// periodic. Differences skip unobserved entries (coverage 0).
class Roughness {
 public:
  // `coverage`: Objective::coverage().
  Roughness(const ModelSpec& spec, std::span<const double> coverage, double slope = 0);

  // `log_parameters`: in the order of FactorModel::parameters(). Those of d, s and unobserved
  // entries do not matter.
  double operator()(std::span<const double> log_parameters) const;

  // Adds factor R to *at, a quadratic model in the logarithms.
  void AddTo(double factor, std::span<const double> log_parameters, QuadraticModel* at) const;

  // The values of `parameters` that minimise R with all others held. Nothing if R does not
  // determine all of them.
  std::optional<std::vector<double>> Interpolated(std::span<const int> parameters,
                                                  std::span<const double> log_parameters) const;

 private:
  struct Difference {
    std::array<int, 3> parameter;
    std::array<double, 3> weight;

    double operator()(std::span<const double> y) const {
      return weight[0] * y[parameter[0]] + weight[1] * y[parameter[1]] +
             weight[2] * y[parameter[2]];
    }
  };

  // Adds the differences along a line of parameters at these places; periodic if period > 0.
  void AddLine(std::span<const int> parameters, std::span<const double> places, double period,
               double share);

  const double slope_;
  std::vector<Difference> differences_;
};

// Damped Gauss-Newton steps in the logarithms y of all parameters, one trial step at a time, on
//   E + lambda E0 R(y) + added term,  E0 = Objective::MeasuredEnergy(),  R = Roughness.
// With x = exp(y),
//   g_y = x g_x,   H_y = diag(x) J'J diag(x) + diag(max(0, x g_x)).
// The last term is the second derivative of the logarithm, omitted where it is negative. Parameters
// stay positive but can approach 0.
class LogStepper {
 public:
  // `slope`: of Roughness. Adds times to *phases.
  LogStepper(const Objective& objective, PhaseSeconds* phases, double slope = 0);

  // Moves to another point. Its zeros are lifted to the smoothest values, or less if that would
  // change E too much.
  void Restart(const FactorModel& model);

  void set_stiffness(double lambda);
  // Takes effect at the next Restart. Must outlive the stepper; null: none.
  void set_added_term(const AddedTerm* term) { added_term_ = term; }

  // Tries one step. Returns false, and keeps the point, if it does not lower minimised().
  bool Step();
  // Whether the damping has reached its maximum: no step lowers minimised().
  bool exhausted() const;

  const FactorModel& current() const { return current_; }
  double E() const { return E_; }
  double roughness() const { return roughness_value_; }
  double penalty() const { return stiffness_ * energy_ * roughness_value_; }  // lambda E0 R
  double minimised() const { return E_ + penalty() + added_; }
  double stiffness() const { return stiffness_; }  // lambda

 private:
  void LiftZeros();
  double AddedAt(const FactorModel& model) const;
  void Linearize();
  std::vector<double> Logarithms(const FactorModel& model) const;

  const Objective& objective_;
  PhaseSeconds* const phases_;
  NormalEquations equations_;
  const Roughness roughness_;
  const double energy_;  // E0
  double stiffness_ = 0;
  const AddedTerm* added_term_ = nullptr;
  FactorModel current_;
  std::vector<double> y_;    // of the tables of current_; 0 for fixed parameters
  std::vector<bool> moves_;  // observed and above 0
  double E_ = 0, roughness_value_ = 0, added_ = 0;
  bool linearized_ = false;
  QuadraticModel at_;           // of E + penalty at current_, in y
  std::vector<double> factor_;  // scratch: A, and its Cholesky factor
  double damping_, growth_ = 2;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_LOG_STEPPER_H_
