#ifndef TRILOBE_SOLVERS_SOLVER_OPTIONS_H_
#define TRILOBE_SOLVERS_SOLVER_OPTIONS_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/option_value.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/iteration_record.h"

namespace trilobe {

// How `lm` keeps parameters >= 0 (docs/solvers.md).
enum class Positivity {
  kActiveSet,  // holds parameters at 0 whose gradient is positive; steps in the others
  kBounds,     // only Ceres' lower bounds: projected steps with a line search
};

const char* PositivityName(Positivity positivity);  // "active_set", "bounds"

enum class TrustRegion { kLevenbergMarquardt, kDogleg };
const char* TrustRegionName(TrustRegion trust_region);  // "levenberg_marquardt", "dogleg"

// ceres::LinearSolverType of a step. kDenseQr and kDenseNormalCholesky store the whole Jacobian,
// [3 samples][parameters]. The Schur solvers eliminate rows of D.
enum class LinearSolver {
  kAuto,  // kDenseQr if the Jacobian takes at most 64 MiB, else kSparseNormalCholesky
  kDenseQr,
  kDenseNormalCholesky,
  kSparseNormalCholesky,
  kDenseSchur,
  kSparseSchur,
  kIterativeSchur,
  kCgnr,
};
const char* LinearSolverName(LinearSolver linear_solver);  // "auto", "dense_qr", ...

// Result of one starting point.
struct StartResult {
  std::string name;      // of a random one with its seed, "roughness/7"
  double objective = 0;  // final E
  int minimum = 0;       // in which it ended: 1 is the lowest; 0 where minima are not told apart
};

// Progress of a solver that tries several starts, in rounds.
struct StartProgress {
  int ended = 0, starts = 0;  // of this round
  int round = 1, rounds = 1;
  double share = 0;  // of all joint steps that the rounds may take; starts that converge take fewer

  // A start that is at its end, where minima are told apart: after its round, in further calls.
  // `minimum` is among the starts so far, the lowest E of which is `lowest`.
  std::optional<StartResult> start = std::nullopt;
  double lowest = 0;
};

// Options of a run. All solvers read the options before g_filter_sigma and `stop`. The others are
// read only by solvers whose SolverEntry::options name them. AllSolverOptions() has flag, help and
// range of each.
struct SolverOptions {
  int max_iterations = 100;
  double max_seconds = std::numeric_limits<double>::infinity();

  // Stop when an accepted iteration changes E by less than this fraction of it.
  double relative_decrease_tolerance = 1e-5;

  // Stop when Diagnosis::optimality is at most this, in solvers that compute it.
  double optimality_tolerance = 1e-10;

  // Fill SolverSummary::diagnosis. Costs a pass over the data and an eigenvalue decomposition.
  bool diagnose = true;

  // Called with every record and its model, from the solving thread. Return false to stop.
  std::function<bool(const IterationRecord&, const FactorModel&)> on_iteration = nullptr;

  // Called when a start has ended its round, by solvers that try several; one call at a time, from
  // any thread.
  std::function<void(const StartProgress&)> on_start = nullptr;

  // Called after every record and within long iterations, from several threads. Return true to
  // stop.
  std::function<bool()> stop = nullptr;

  // Standard deviation [G nodes] of the paper's Gaussian filter on G after each sweep; 0 for none.
  // The filter may raise E.
  double g_filter_sigma = 0;

  // Called with the model after every update of an element or a block of elements, by solvers that
  // make such updates. Slow; for tests that E never rises.
  std::function<void(const FactorModel&)> on_element = nullptr;

  Positivity positivity = Positivity::kActiveSet;
  TrustRegion trust_region = TrustRegion::kLevenbergMarquardt;

  // Members of ceres::Solver::Options.
  bool nonmonotonic = false;  // use_nonmonotonic_steps: a step is compared with several before
  LinearSolver linear_solver = LinearSolver::kAuto;
  bool inner_iterations = false;  // use_inner_iterations: minimise block by block after each step

  // Number of earlier iterates that Anderson acceleration combines.
  int memory = 5;

  // Number of starting points, including the given one, and the seed of the random ones.
  int starts = 8;
  uint64_t seed = 1;
};

// Describes a member of SolverOptions that is not a callback.
struct SolverOption {
  // For a flag in another unit than the member.
  struct FlagUnit {
    double default_value = 0;
    OptionRange range = {};
    double (*to_member)(double flag, const ModelSpec& spec) = nullptr;  // null: no conversion
  };

  std::string name = {};  // of the member, also used in reports
  bool common = false;    // read by all solvers; else by those whose SolverEntry::options name it
  std::string flag = {};  // flag of the program; empty: `name`
  std::string help = {};  // help of the flag; empty if the flag is not for solvers alone
  OptionRange range = {};
  std::optional<FlagUnit> unit = std::nullopt;

  std::function<OptionValue(const SolverOptions&)> get = {};
  // `value` has the type that `get` returns. Throws Error for an unknown enumerator.
  std::function<void(const OptionValue& value, SolverOptions* options)> set = {};
};

// All options, in the order of SolverOptions.
const std::vector<SolverOption>& AllSolverOptions();

// Throws Error for an unknown name; the message lists the known ones.
const SolverOption& FindSolverOption(std::string_view name);

// The common options and those named in `particular` (SolverEntry::options), in the order of
// SolverOptions.
std::vector<const SolverOption*> OptionsReadBy(std::span<const std::string> particular);

// Throws Error with name and value if a number is out of range.
void CheckSolverOptions(const SolverOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SOLVER_OPTIONS_H_
