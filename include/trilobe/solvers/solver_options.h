#ifndef TRILOBE_SOLVERS_SOLVER_OPTIONS_H_
#define TRILOBE_SOLVERS_SOLVER_OPTIONS_H_

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/iteration_record.h"

namespace trilobe {

// How the joint solvers keep parameters >= 0 (docs/solvers.md compares them).
enum class Positivity {
  kActiveSet,  // step in the parameters that are free to move, projected on x >= 0
  kBounds,     // Ceres' lower bounds: projected steps with a line search
};

const char* PositivityName(Positivity positivity);  // "active_set", "bounds"

enum class TrustRegion { kLevenbergMarquardt, kDogleg };
const char* TrustRegionName(TrustRegion trust_region);  // "levenberg_marquardt", "dogleg"

// How Ceres solves the linear least-squares problem of a step: ceres::LinearSolverType. Those by QR
// and dense Cholesky store the whole Jacobian, [3 samples][parameters]; a Schur complement
// eliminates rows of D.
enum class LinearSolver {
  kAuto,  // dense QR where the Jacobian takes at most 64 MiB, else sparse Cholesky
  kDenseQr,
  kDenseNormalCholesky,
  kSparseNormalCholesky,
  kDenseSchur,
  kSparseSchur,
  kIterativeSchur,
  kCgnr,
};
const char* LinearSolverName(LinearSolver linear_solver);  // "auto", "dense_qr", ...

// What a run is asked to do. The first part is common to all solvers; each option of the second
// part is one that only some solvers read, and SolverEntry::options says which. What else there is
// to say of an option (flag, help, range) is in AllSolverOptions(), a row an option.
struct SolverOptions {
  int max_iterations = 100;
  double max_seconds = std::numeric_limits<double>::infinity();

  // Stop when an accepted iteration changes E by less than this fraction of it.
  double relative_decrease_tolerance = 1e-5;

  // Stop when the scaled projected gradient (Diagnosis::optimality) is at most this, where the
  // solver knows it.
  double optimality_tolerance = 1e-10;

  // Fill SolverSummary::diagnosis: one pass over the data and one eigenvalue decomposition.
  bool diagnose = true;

  // Sees every record and the model it belongs to, from the solving thread; returns false to stop.
  std::function<bool(const IterationRecord&, const FactorModel&)> on_iteration = nullptr;

  // Asked after every record, and where an iteration takes long in the midst of it, from several
  // threads: true to stop, as if on_iteration had said so.
  std::function<bool()> stop = nullptr;

  // Standard deviation, in G nodes, of the paper's Gaussian filter on G after each sweep; 0 for no
  // filter. With the filter E may rise.
  double g_filter_sigma = 0;

  // Sees the model after every update of a single element, or of a block of elements that move
  // together, where a solver makes such updates. Slow; for checking that E never rises.
  std::function<void(const FactorModel&)> on_element = nullptr;

  Positivity positivity = Positivity::kActiveSet;
  TrustRegion trust_region = TrustRegion::kLevenbergMarquardt;

  // Of Ceres, under the names that it has for them in ceres::Solver::Options.
  bool nonmonotonic = false;  // use_nonmonotonic_steps: judged against several before
  LinearSolver linear_solver = LinearSolver::kAuto;
  bool inner_iterations = false;  // use_inner_iterations: then block by block, after each step

  // Earlier iterates that an accelerated solver combines.
  int memory = 5;

  // Starting points to try, the given one among them, and the seed of the random ones.
  int starts = 8;
  uint64_t seed = 1;
};

// Choices are given by their names.
using OptionValue = std::variant<bool, int, uint64_t, double, std::string>;

// Which numbers an option may be.
struct OptionRange {
  const char* must_be = "";                // for errors: "0 or more"
  bool (*holds)(double number) = nullptr;  // null: any
};

// A member of SolverOptions that is no callback: all that programs and reports need to know of it.
struct SolverOption {
  // Of a flag that is not simply the member, but a number to make it from.
  struct FlagUnit {
    double default_value = 0;
    OptionRange range = {};
    double (*to_member)(double flag, const ModelSpec& spec) = nullptr;  // null: as it is
  };

  std::string name = {};  // of the member, and in reports
  bool common = false;    // all solvers read it; else those whose SolverEntry::options name it
  std::string flag = {};  // of the program; by default the name
  std::string help = {};  // of the flag; none where the program has that flag for more than solvers
  OptionRange range = {};
  std::optional<FlagUnit> unit = std::nullopt;

  std::function<OptionValue(const SolverOptions&)> get = {};
  // `value` is of the type that `get` returns. Throws Error for a choice that there is not.
  std::function<void(const OptionValue& value, SolverOptions* options)> set = {};
};

// In the order of SolverOptions.
const std::vector<SolverOption>& AllSolverOptions();

// Throws Error that lists the known names.
const SolverOption& FindSolverOption(std::string_view name);

// The options that all solvers read and those of `particular` (SolverEntry::options), in the order
// of SolverOptions.
std::vector<const SolverOption*> OptionsReadBy(std::span<const std::string> particular);

// Throws Error, with the name and the value, where a number is out of its range.
void CheckInRange(const std::string& name, const OptionValue& value, const OptionRange& range);
void CheckSolverOptions(const SolverOptions& options);

// "60", "0.001", "true", "active_set".
std::string ToText(const OptionValue& value);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SOLVER_OPTIONS_H_
