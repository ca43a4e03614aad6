#ifndef TRILOBE_SOLVERS_JOINT_PLAIN_PROBLEM_H_
#define TRILOBE_SOLVERS_JOINT_PLAIN_PROBLEM_H_

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <set>
#include <utility>
#include <vector>

#include "solvers/joint/ceres_run.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/parameter_blocks.h"
#include "trilobe/solvers/solver_options.h"

namespace trilobe {

// E / residual_unit^2 as a problem for Ceres: a residual block of three residuals (R, G, B) per
// sample; a parameter block with bounds for d, s, and each row of D, F and G (ParameterBlocks).
// Unobserved parameters are constant.
class PlainProblem {
 public:
  explicit PlainProblem(const CeresParameters& parameters);

  ceres::Problem* problem() { return &problem_; }

  // `asked`, or a linear solver for this problem if that is kAuto.
  LinearSolver Choose(LinearSolver asked) const;

  // CeresOptions with the options that depend on the problem: the first elimination group of a
  // Schur complement and inner iterations. The linear solver must not be kAuto (Choose).
  ceres::Solver::Options OptionsFor(const SolverOptions& options, int num_threads);

  // Rows of D for the first elimination group; no sample reads two of them. All rows on a grid,
  // about every other one if samples lie between rows.
  std::vector<int> IndependentRows() const;

  // The model with the current values of the blocks.
  FactorModel Model() const;

 private:
  void AddSample(WeightedSample sample);
  void Constrain(int b, const std::vector<double>& coverage);

  const CeresParameters& parameters_;
  ParameterBlocks blocks_;
  std::vector<int> block_numbers_;          // scratch: of one sample
  std::set<std::pair<int, int>> together_;  // pairs of rows of D read by one sample, ascending
  ceres::Problem problem_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_PLAIN_PROBLEM_H_
