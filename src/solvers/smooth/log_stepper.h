#ifndef TRILOBE_SOLVERS_SMOOTH_LOG_STEPPER_H_
#define TRILOBE_SOLVERS_SMOOTH_LOG_STEPPER_H_

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

// A term that is minimised beside E.
class AddedTerm {
 public:
  virtual ~AddedTerm() = default;

  virtual double operator()(const FactorModel& model) const = 0;
  // Makes E + this term of E, to second order around a model, in all its parameters.
  virtual void AddTo(const FactorModel& model, QuadraticModel* at) const = 0;
};

// How rough the tables of a model are: the sum of squares of second differences of their
// logarithms y, so that neither scale nor a steady fall costs anything, or the fall `slope` times
// the squares of first differences.
//   R(y) = sum_tables sum_k (y_k-1 - 2 y_k + y_k+1)^2 + slope sum_k (y_k+1 - y_k)^2
// on the MERL grid. Elsewhere divided differences stand for these, and each k counts by the width
// around it, so that R is the integral of the squared second derivative whatever the nodes are:
// over theta in degrees, for D over 90 sqrt(theta / 90 degrees). Of tables over azimuths it is the
// mean over phi of that, and the mean over theta of the same along phi, periodic. Entries that no
// data touch (coverage 0) have no part; the differences reach across them.
class Roughness {
 public:
  // `coverage`: Objective::coverage().
  Roughness(const ModelSpec& spec, std::span<const double> coverage, double slope = 0);

  // `log_parameters`: in the order of FactorModel::parameters(); of d, s and unobserved entries
  // any.
  double operator()(std::span<const double> log_parameters) const;

  // Makes E + factor R of E, to second order, with *at in the logarithms.
  void AddTo(double factor, std::span<const double> log_parameters, QuadraticModel* at) const;

  // The values of these at which R is least, all others held; nothing where that leaves one of them
  // free.
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

  // Along a line of parameters at these places; with a period its end meets its beginning.
  void AddLine(std::span<const int> parameters, std::span<const double> places, double period,
               double share);

  const double slope_;
  std::vector<Difference> differences_;
};

// Damped Gauss-Newton steps in the logarithms y of all parameters, which lower
//   E + lambda E0 R(y) + an added term,  E0 = Objective::MeasuredEnergy(),  R = Roughness,
// the latter none by default, one trial step at a time. With x = exp(y),
//   g_y = x g_x,   H_y = diag(x) J'J diag(x) + diag(max(0, x g_x)):
// the last term, the part of the second derivative that logarithms bring in, is left out where it
// would make H indefinite. No parameter can become 0, but nothing keeps it from coming near.
class LogStepper {
 public:
  // `slope`: Roughness. Times go to *phases.
  LogStepper(const Objective& objective, PhaseSeconds* phases, double slope = 0);

  // Goes on from another point, whose zeros, which no factor can move, are lifted to what is
  // smoothest beside their neighbours or, if that is less, as far as does little to E.
  void Restart(const FactorModel& model);

  void set_stiffness(double lambda);
  // From the next Restart on. Outlives the stepper; null: none.
  void set_added_term(const AddedTerm* term) { added_term_ = term; }

  // Tries one step; false if it did not lower what is minimised, so that the point stayed where
  // it was.
  bool Step();
  // No damping leads lower.
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
  std::vector<double> y_;    // of the tables of current_; 0 for what does not move
  std::vector<bool> moves_;  // observed, and above 0
  double E_ = 0, roughness_value_ = 0, added_ = 0;
  bool linearized_ = false;
  QuadraticModel at_;           // of E + penalty at current_, in y
  std::vector<double> factor_;  // scratch: A, and its Cholesky factor
  double damping_, growth_ = 2;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SMOOTH_LOG_STEPPER_H_
