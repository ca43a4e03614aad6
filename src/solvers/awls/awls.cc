#include "solvers/awls/awls.h"

#include <memory>

#include "solvers/sweep.h"
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

// Alternating weighted least squares, in which d and s of a channel, D of all lobes in a theta_h
// bin, and F of all lobes in a theta_d bin move together, as non-negative least squares, and
// several times for each pass over the samples.
class AwlsBlock : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("awls_block", objective, options, model);
    const std::unique_ptr<Sweep> sweep = MakeSweep(objective, &run.summary().phases);
    const auto& trace = run.summary().trace;
    RepeatSweeps(
        [&](FactorModel* current) {
          sweep->SweepInBlocks(trace.back(), options.on_element, current);
        },
        objective, *model, &run);
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

SolverEntry AwlsBlockEntry() {
  return {.name = "awls_block",
          .description = "awls with all lobes at once, and several rounds of d, s, D, F a sweep",
          .reference = "Lawson and Hanson 1974, chapter 23; exact sums: docs/sums.md",
          .options = {"g_filter_sigma"},
          .make = [] { return std::make_unique<AwlsBlock>(); }};
}

}  // namespace trilobe
