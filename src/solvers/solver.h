#ifndef TRILOBE_SOLVERS_SOLVER_H_
#define TRILOBE_SOLVERS_SOLVER_H_

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/iteration_record.h"
#include "trilobe/model/objective.h"

namespace trilobe {

enum class StopReason {
  kConverged,  // relative decrease of E in one iteration below the tolerance
  kExactFit,   // E is at the rounding error of the data: nothing left to fit
  kMaxIterations,
  kMaxSeconds,
  kInterrupted,  // a callback asked to stop
};
const char* StopReasonName(StopReason reason);  // "converged", "exact_fit", ...

struct SolverOptions {
  int max_iterations = 60;
  double max_seconds = std::numeric_limits<double>::infinity();

  // Stop when an iteration changes E by less than this fraction of it.
  double relative_decrease_tolerance = 1e-3;

  // Standard deviation, in G nodes, of the paper's Gaussian filter on G after each sweep; 0 for no
  // filter. With the filter E may rise.
  double g_filter_sigma = 0;

  // Sees every record and the model it belongs to, from the solving thread; returns false to stop.
  std::function<bool(const IterationRecord&, const FactorModel&)> on_iteration;

  // Sees the model after every single element update, where a solver makes such updates. Slow;
  // for checking that E never rises.
  std::function<void(const FactorModel&)> on_element;
};

struct SolverSummary {
  std::string solver;
  StopReason stop_reason = StopReason::kMaxIterations;
  double initial_objective = 0;
  double final_objective = 0;  // of the returned model: the lowest E that was recorded
  int iterations = 0;          // made, which may be more than the returned model's number
  double seconds = 0;
  std::vector<IterationRecord> trace;  // trace[0] is the starting point

  // One line: solver, iterations, E from and to, why it stopped.
  std::string BriefReport() const;
};

// Fits a model to an objective. Stateless: everything about a run is in its arguments.
class Solver {
 public:
  Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
  virtual ~Solver() = default;

  // Starts at *model, whose spec is the objective's and whose numbers are finite and >= 0, and
  // leaves the best model found there; dead bins stay as they were.
  // Throws Error if this solver cannot work on this objective.
  virtual SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                              FactorModel* model) const = 0;
};

// A solver by name, for flags and lists.
struct SolverEntry {
  std::string name;
  std::string description;  // one line, with its reference
  std::function<std::unique_ptr<Solver>()> make;
};

// All solvers, the default one first.
const std::vector<SolverEntry>& Solvers();

// Throws Error that lists the known names.
std::unique_ptr<Solver> MakeSolver(std::string_view name);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SOLVER_H_
