#ifndef TRILOBE_SOLVERS_CERES_PLAIN_PROBLEM_H_
#define TRILOBE_SOLVERS_CERES_PLAIN_PROBLEM_H_

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <set>
#include <utility>
#include <vector>

#include "solvers/ceres/ceres_run.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/parameter_blocks.h"
#include "trilobe/solvers/solver_options.h"

namespace trilobe {

// E / residual_unit^2 as a problem for Ceres: a residual block of three residuals, R, G and B, for
// each sample; a parameter block for d, s, and each row of D, F and G (ParameterBlocks), under
// bounds. Unobserved parameters are constant.
class PlainProblem {
 public:
  explicit PlainProblem(const CeresParameters& parameters);

  ceres::Problem* problem() { return &problem_; }

  // The linear solver that is asked for or, where that is kAuto, one for this problem.
  LinearSolver Choose(LinearSolver asked) const;

  // CeresOptions and what depends on the problem: the first elimination group of a Schur
  // complement, and inner iterations. `options` names a linear solver (Choose).
  ceres::Solver::Options OptionsFor(const SolverOptions& options, int num_threads);

  // Rows of D no two of which are read by one sample, as the first elimination group must be: all
  // of them on a grid, about every other one where samples lie between two rows.
  std::vector<int> IndependentRows() const;

  // The model that the blocks hold now.
  FactorModel Model() const;

 private:
  void AddSample(WeightedSample sample);
  void Constrain(int b, const std::vector<double>& coverage);

  const CeresParameters& parameters_;
  ParameterBlocks blocks_;
  std::vector<int> block_numbers_;          // scratch: of one sample
  std::set<std::pair<int, int>> together_;  // pairs of rows of D that a sample reads, ascending
  ceres::Problem problem_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_CERES_PLAIN_PROBLEM_H_
