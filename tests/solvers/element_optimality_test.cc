// An element's update puts it where E is lowest: no other value, near or far, is better.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/solvers/solver_kinds.h"
#include "tests/test_util.h"
#include "trilobe/solvers/solver.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

TEST(ElementOptimality, NoOtherValueIsBetter) {
  constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 9};
  const BrdfTable table = RandomTable(kGrid, 1);
  for (const auto& [name, spec] : TestSpecs(kGrid)) {
    const Objective objective = MakeObjective(table, spec);
    for (const SolverEntry& solver : kLibrarySolvers) {
      if (!UpdatesElements(solver)) continue;
      FactorModel model = RandomModel(spec, 2);
      int element = 0;  // updates come in the order of parameters()
      SolverOptions options;
      options.max_iterations = 2;
      options.relative_decrease_tolerance = 0;
      // Named captures: clang 14 does not capture structured bindings by itself.
      options.on_element = [&, &name = name, &spec = spec](const FactorModel& now) {
        const int k = element++ % spec.num_parameters();
        const double E = objective.Value(now), x = now.parameters()[k];
        FactorModel other = now;
        for (const double y : {0.0, 0.5 * x, 0.9 * x, 0.999 * x, 1.001 * x, 1.1 * x, 2 * x, 10 * x,
                               0.01, 0.1, 1.0, 10.0}) {
          other.parameters()[k] = y;
          EXPECT_GE(objective.Value(other), E * (1 - 1e-12))
              << name << ", " << solver.name << ", parameter " << k << ": " << x << " to " << y;
        }
      };
      solver.make()->Solve(objective, options, &model);
      EXPECT_EQ(element, 2 * spec.num_parameters());
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
