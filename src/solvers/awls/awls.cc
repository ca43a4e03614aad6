#include "solvers/awls/awls.h"

#include <memory>

#include "solvers/awls/make_sweep.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// Alternating weighted least squares (paper 2.3) from exact sums.
class Awls : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("awls", objective, options, model);
    const std::unique_ptr<Sweep> sweep = MakeSweep(objective, &run.summary().phases);
    RepeatSweeps([&](FactorModel* current) { (*sweep)(options.on_element, current); }, objective,
                 *model, &run);
    return run.Finish();
  }
};

}  // namespace

SolverEntry AwlsEntry() {
  return {.name = "awls",
          .description = "alternating weighted least squares, one parameter at a time",
          .reference = "Peng, Zheng, Lv, section 2.3; exact sums: docs/sums.md",
          .options = {"g_filter_sigma"},
          .make = [] { return std::make_unique<Awls>(); }};
}

}  // namespace trilobe
