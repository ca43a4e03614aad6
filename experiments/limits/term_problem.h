#ifndef TRILOBE_EXPERIMENTS_LIMITS_TERM_PROBLEM_H_
#define TRILOBE_EXPERIMENTS_LIMITS_TERM_PROBLEM_H_

#include <functional>
#include <span>
#include <vector>

#include "experiments/limits/term_model.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// E of models of terms over the samples of an objective, by its weights:
//   E = sum_j sum_c w_jc (rho_c(j) - rho*_jc)^2.
// Channels are R, G and B or, with `bands`, the wavelengths that the samples have; a sample then
// weighs the same in all: the mean of its weights. Samples are summed one by one, whatever the
// grid.
class TermProblem {
 public:
  // Throws Error for an invalid spec, one of another number of channels, and without spectra if
  // `bands`.
  TermProblem(const Objective& objective, const TermSpec& spec, bool bands = false);

  const TermSpec& spec() const { return spec_; }
  int size() const { return static_cast<int>(samples_.size()); }
  double MeasuredEnergy() const { return energy_; }  // E of a black model

  // Both: the same bits for any number of threads. Throw Error for a model of another spec.
  double Value(const TermModel& model) const;
  // J'r, and J'J in both triangles, in the order of TermModel::parameters(); 0 for fixed tables.
  void Linearize(const TermModel& model, QuadraticModel* result) const;

 private:
  struct Sample {
    TermReader::At at;
    std::vector<double> weight, rho;  // [channels]
  };
  class Accumulator;

  void CheckSpec(const TermModel& model) const;

  const TermSpec spec_;
  const TermReader reader_;
  const int num_threads_;
  std::vector<Sample> samples_;
  std::vector<bool> shared_;  // of each parameter: whether channels share it
  double energy_ = 0;
};

struct TermFit {
  TermModel model;
  std::vector<double> trace;  // E of the start, and after each step
  bool converged = false;     // the last step lowered E by less than `tolerance`
};

struct TermFitOptions {
  int max_steps = 100;
  double tolerance = 1e-5;  // relative, of E
  StopCheck stop = {};
  std::function<void(int step, double E)> on_step = nullptr;
};

// Lowers E by damped Gauss-Newton steps in all parameters that are not fixed, under bounds x >= 0
// (NonnegativeStep); E never rises. An entry of a table that no sample reads is multiplied by what
// the nearest entry that is read has been multiplied by. Throws Error for a start of another spec.
TermFit FitTerms(const TermProblem& problem, const TermModel& start,
                 const TermFitOptions& options = {});

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_LIMITS_TERM_PROBLEM_H_
