#ifndef TRILOBE_TESTS_FIT_FINISH_FITTED_H_
#define TRILOBE_TESTS_FIT_FINISH_FITTED_H_

#include <algorithm>
#include <cmath>
#include <utility>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {

// Model of joint steps from lobes of several widths, for tests of the steps after a fit.
inline FactorModel Fitted(const Objective& objective, int max_iterations) {
  FactorModel model(objective.spec());
  std::ranges::fill(model.parameters(), 0.5);
  for (int m = 0; m < model.spec().lobes; ++m) {  // or they stay equal
    for (double& x : model.s(m)) x *= 1 + m;
    const auto D = model.table(Factor::kD, objective.spec().table(Factor::kD, m, 0));
    for (size_t k = 0; k < D.size(); ++k) D[k] = std::exp(-static_cast<double>(k) / (2 + 4 * m));
  }
  MakeSolver("varpro")->Solve(objective, {.max_iterations = max_iterations, .diagnose = false},
                              &model);
  return model;
}

// An objective, and the model that a solver finds from the first start.
struct Solved {
  Objective objective;
  FactorModel model;
};

inline Solved SolveFromFirstStart(Objective objective) {
  FactorModel model = InitialModels().front().make(objective, 1);
  MakeSolver("varpro")->Solve(objective, {.max_iterations = 10, .diagnose = false}, &model);
  return {std::move(objective), std::move(model)};
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_FIT_FINISH_FITTED_H_
