#ifndef TRILOBE_SOLVERS_SOLVER_H_
#define TRILOBE_SOLVERS_SOLVER_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver_options.h"

namespace trilobe {

// Why a run ended: one list for all solvers.
enum class StopReason {
  kConverged,   // relative decrease of E in one iteration below the tolerance
  kOptimal,     // scaled projected gradient below the tolerance, or what is left to gain is below
                // the rounding of E
  kExactFit,    // E is at the rounding error of the data: nothing left to fit
  kNoDecrease,  // the solver finds no step that lowers E
  kMaxIterations,
  kMaxSeconds,
  kInterrupted,  // a callback asked to stop
};
const char* StopReasonName(StopReason reason);  // "converged", "exact_fit", ...

// Where the time of a run went [s], summed over what ran side by side. What a solver does besides
// is in none of them.
struct PhaseSeconds {
  double reading = 0;         // not a solver's: for the caller to fill
  double preparing = 0;       // sorting and copying before the first iteration
  double evaluating = 0;      // passes over the samples: E, sums, normal equations
  double tracing = 0;         // passes for E where only trace and stopping test want it
  double linear_algebra = 0;  // factorisations and element updates
  double diagnosing = 0;

  PhaseSeconds& operator+=(const PhaseSeconds& other);
};

// How good a point is, by measures that do not depend on the gauge (docs/solvers.md).
struct Diagnosis {
  // dE/dx / 2 = J'r, in the order of FactorModel::parameters(); 0 at unobserved bins.
  std::vector<double> gradient;

  // The largest projected component of the gradient in the scale in which every column of J has
  // length 1, over |r|: the cosine between the residual and the direction that lowers E most.
  // 0 at a stationary point, at most 1.
  double optimality = 0;

  int observed_parameters = 0;  // those that data touch
  // Of J with its columns scaled to length 1, columns of length 0 left out: singular values above
  // `rank_tolerance` times the largest, and the largest over the smallest of those.
  int rank = 0;
  double rank_tolerance = 0;
  double condition = 0;
  // Columns that are not 0, less the directions along which scale moves between tables and s
  // without changing any value, less `rank`: what J'J cannot tell from 0, but theory does.
  int unresolved = 0;
};

// Where one of several starting points led.
struct StartResult {
  std::string name;
  double objective = 0;  // E there
};

struct SolverSummary {
  std::string solver;
  std::vector<std::string> own_options;  // that it reads and not all do, if MakeSolver made it
  StopReason stop_reason = StopReason::kMaxIterations;
  // E of the data at the start and of the returned model. That is the one with the lowest recorded
  // E of what is minimised, which with a prior is another (IterationRecord::objective_with_prior).
  double initial_objective = 0;
  double final_objective = 0;
  int iterations = 0;                  // made, which may be more than the returned model's number
  double seconds = 0;                  // of the last record: without the diagnosis
  std::vector<IterationRecord> trace;  // trace[0] is the starting point

  SolverOptions given;  // as they came, without the callbacks
  SolverOptions used;   // as the solver replaced what it could not honour or was free to choose
  std::vector<std::string> notes;  // one sentence for each such choice, and for each warning
  PhaseSeconds phases;
  std::vector<StartResult> starts;     // of a solver that tries several, best first
  std::optional<Diagnosis> diagnosis;  // of the returned model

  int BestIteration() const;  // the returned model's number in the trace
  int RejectedSteps() const;  // iterations whose step was taken back
  // The iterations that ended above the one before, in what the solver lowers, by more than
  // rounding (1e-12 of it); AWLS without a filter has none (docs/solvers.md).
  struct Raises {
    std::vector<int> iterations;
    double largest = 0;  // as a fraction of what it was before
  };
  Raises FindRaises() const;
  bool has_prior() const {
    return !trace.empty() && trace.front().objective_with_prior.has_value();
  }

  // One line: solver, iterations, E from and to, why it stopped.
  std::string BriefReport() const;
  // Several lines, each with its newline: that, and options, notes, diagnosis and phases.
  std::string FullReport() const;
};

// Fits a model to an objective. Stateless: everything about a run is in its arguments.
class Solver {
 public:
  Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
  virtual ~Solver() = default;

  // Starts at *model, whose spec is the objective's and whose parameters are finite and >= 0, and
  // leaves the best model found there; unobserved bins stay as they were.
  // Throws Error, with *model as it was, if that is no such model or E overflows there, if an
  // option is out of its range, or if this solver cannot work on this objective.
  SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                      FactorModel* model) const;

 private:
  friend std::unique_ptr<Solver> MakeSolver(std::string_view name);

  // Solve, of arguments that have been checked.
  virtual SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                                FactorModel* model) const = 0;

  std::vector<std::string> own_options_;
};

// A solver by name, for flags and lists.
struct SolverEntry {
  std::string name;
  std::string description;                // one line
  std::string reference;                  // where the method is from
  std::vector<std::string> options = {};  // that it reads and not all do (AllSolverOptions)
  std::function<std::unique_ptr<Solver>()> make;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SOLVER_H_
