#ifndef TRILOBE_SOLVERS_SOLVER_H_
#define TRILOBE_SOLVERS_SOLVER_H_

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver_options.h"

namespace trilobe {

// Why a run ended; the same list for all solvers.
enum class StopReason {
  kConverged,   // the relative change of E in one iteration is below the tolerance
  kOptimal,     // the scaled projected gradient is at most the tolerance, or a step would lower E
                // by less than its rounding error
  kExactFit,    // E is at the rounding error of the data
  kNoDecrease,  // the solver finds no step that lowers E
  kMaxIterations,
  kMaxSeconds,
  kInterrupted,  // a callback asked to stop
};
const char* StopReasonName(StopReason reason);  // "converged", "exact_fit", ...

// Whether a solver has found what it looks for: neither a limit nor a callback stopped it.
bool HasEnded(StopReason reason);

// Time spent in each phase of a run [s]. Times of phases that run in parallel are added up. The
// phases do not cover all of a run.
struct PhaseSeconds {
  double reading = 0;         // filled by the caller, not by a solver
  double preparing = 0;       // sorting and copying before the first iteration
  double evaluating = 0;      // passes over the samples: E, sums, normal equations
  double tracing = 0;         // evaluations of E for the trace and the stopping test only
  double linear_algebra = 0;  // factorisations and element updates
  double diagnosing = 0;

  PhaseSeconds& operator+=(const PhaseSeconds& other);
};

// First- and second-order measures of a point that do not depend on the gauge (docs/solvers.md).
struct Diagnosis {
  // dE/dx / 2 = J'r, in the order of FactorModel::parameters(); 0 at unobserved bins.
  std::vector<double> gradient;

  // The largest component of the projected gradient over |r|, with the columns of J scaled to
  // length 1. 0 at a stationary point, at most 1.
  double optimality = 0;

  int observed_parameters = 0;  // parameters that affect the value of a sample
  // Numerical rank of J with its columns scaled to length 1 and zero columns removed: `rank` is the
  // number of singular values above `rank_tolerance` times the largest, `condition` the largest of
  // them over the smallest.
  int rank = 0;
  double rank_tolerance = 0;
  double condition = 0;
  // Directions that J'J cannot tell from 0 although they are not gauge directions: nonzero columns
  // minus gauge directions (which move scale between tables and s) minus `rank`.
  int unresolved = 0;
};

struct SolverSummary {
  std::string solver;
  std::vector<std::string> own_options;  // SolverEntry::options; empty without MakeSolver
  StopReason stop_reason = StopReason::kMaxIterations;
  // E of the data at the start and of the returned model. The returned model is the recorded one
  // with the lowest minimised E, which includes the prior if there is one
  // (IterationRecord::objective_with_prior).
  double initial_objective = 0;
  double final_objective = 0;
  int iterations = 0;                  // number made; at least BestIteration()
  double seconds = 0;                  // of the last record; excludes the diagnosis
  std::vector<IterationRecord> trace;  // trace[0] is the starting point

  SolverOptions given;             // as passed to Solve, without the callbacks
  SolverOptions used;              // after the solver replaced unsupported or automatic values
  std::vector<std::string> notes;  // one sentence for each replacement and each warning
  PhaseSeconds phases;
  std::vector<StartResult> starts;     // of solvers with several starts, best first
  std::optional<Diagnosis> diagnosis;  // of the returned model

  int BestIteration() const;  // index of the returned model in the trace
  int RejectedSteps() const;  // number of iterations whose step was rejected
  // Iterations that raised the minimised E by more than rounding (1e-12 of it). AWLS without a
  // filter has none (docs/solvers.md).
  struct Raises {
    std::vector<int> iterations;
    double largest = 0;  // relative to the value before
  };
  Raises FindRaises() const { return FindRaises(trace); }
  static Raises FindRaises(std::span<const IterationRecord> trace);
  bool has_prior() const {
    return !trace.empty() && trace.front().objective_with_prior.has_value();
  }

  // One line: solver, iterations, initial and final E, stop reason.
  std::string BriefReport() const;
  // Several lines, each ending in a newline: also options, notes, diagnosis and phases.
  std::string FullReport() const;
};

// Fits a model to an objective. A solver has no state of its own. Use:
//
//   const Objective objective(SamplesOf(measurement), ModelSpec(), Weightings().front());
//   FactorModel model = FindInitialModel("analytic").make(objective, /*seed=*/1);
//   const SolverSummary summary = MakeSolver("varpro")->Solve(objective, {}, &model);
//   std::cout << summary.FullReport();
class Solver {
 public:
  Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;
  virtual ~Solver() = default;

  // Starts at *model and replaces it by the best model found. *model must have the objective's
  // spec and parameters that are finite and >= 0. Unobserved bins do not change.
  // Throws Error, and leaves *model unchanged, if *model is invalid, E overflows at it, an option
  // is out of range, or the solver does not support the objective.
  SolverSummary Solve(const Objective& objective, const SolverOptions& options,
                      FactorModel* model) const;

 private:
  friend std::unique_ptr<Solver> MakeSolver(std::string_view name);

  // Implements Solve; the arguments have been checked.
  virtual SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                                FactorModel* model) const = 0;

  std::vector<std::string> own_options_;
};

// A registered solver.
struct SolverEntry {
  std::string name;
  std::string description;                // one line
  std::string reference;                  // publication of the method
  std::vector<std::string> options = {};  // names of the non-common options that it reads
  std::function<std::unique_ptr<Solver>()> make;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SOLVER_H_
