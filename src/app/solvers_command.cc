#include <iostream>

#include "app/command.h"
#include "app/help.h"
#include "app/solver_flags.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

int RunSolvers(std::span<const std::string> arguments) {
  if (!arguments.empty()) {
    std::cout << Wrapped(DescribeSolver(FindSolver(arguments[0])), OutputWidth())
              << "Flags of all solvers: `trilobe help fit`\n";
    return 0;
  }
  std::string text;
  const std::string& default_name = Solvers().front().name;
  for (const SolverEntry& solver : Solvers()) {
    text += solver.name + (solver.name == default_name ? " (default)" : "") + "\n    " +
            solver.description + "\n    " + solver.reference + "\n\n";
  }
  text.pop_back();
  std::cout << Wrapped(text, OutputWidth());
  return 0;
}

}  // namespace

Command SolversCommand() {
  return {.name = "solvers",
          .summary = "list the solvers of `trilobe fit`, or describe one",
          .arguments = "[NAME]",
          .min_arguments = 0,
          .max_arguments = 1,
          .details =
              "Without NAME, lists the solvers, the default one first, with the references of "
              "their methods.\nWith NAME, describes that solver and the flags of `trilobe fit` "
              "that only some solvers take.",
          .flags = {},
          .run = RunSolvers};
}

}  // namespace trilobe
