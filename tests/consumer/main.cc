#include <trilobe/formats/source.h>
#include <trilobe/registry/solvers.h>
#include <trilobe/solvers/solver.h>
#include <trilobe/start/initial_model.h>

#include <iostream>

int main() {
  using namespace trilobe;
  const BrdfTable measured = LoadSource("synth:plastic", {.noise = 0.02});
  const Objective objective(ValidSamples(measured), ModelSpec::SharedFactors(/*lobes=*/3),
                            FindWeighting("appearance"));
  FactorModel model = InitialModels().front().make(objective, /*seed=*/1);
  const SolverSummary summary = MakeSolver("awls")->Solve(objective, {.max_iterations = 5}, &model);
  std::cout << summary.BriefReport() << "\n";
  return summary.final_objective < summary.initial_objective ? 0 : 1;
}
