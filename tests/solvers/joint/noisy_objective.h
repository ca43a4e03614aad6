#ifndef TRILOBE_TESTS_SOLVERS_JOINT_NOISY_OBJECTIVE_H_
#define TRILOBE_TESTS_SOLVERS_JOINT_NOISY_OBJECTIVE_H_

#include <vector>

#include "tests/test_util.h"

namespace trilobe {

// A model and a measurement of it with noise; then the model is moved away.
inline Objective NoisyObjective(const MerlGrid& grid, int lobes, FactorModel* model) {
  const ModelSpec spec = ModelSpec::SharedFactors(lobes, grid);
  *model = RandomModel(spec, 1, 0.3);
  BrdfTable table = TableOf(*model, grid);
  Random random(2);
  for (std::vector<double>& channel : table.stored) {
    for (double& value : channel) value *= random.LogNormal(0.05);
  }
  for (double& x : model->parameters()) x *= random.LogNormal(0.2);
  return MakeObjective(table, spec);
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_SOLVERS_JOINT_NOISY_OBJECTIVE_H_
