#include "solvers/joint/ceres_run.h"

#include <ceres/iteration_callback.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include "core/algebra/element_step.h"
#include "core/algebra/openblas.h"
#include "model/objective/gauge.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

class Recorder : public ceres::IterationCallback {
 public:
  Recorder(const std::function<CeresPoint()>& current, Run* run) : current_(current), run_(*run) {}

  ceres::CallbackReturnType operator()(const ceres::IterationSummary& iteration) override {
    if (iteration.iteration == 0) return ceres::SOLVER_CONTINUE;  // recorded by Run::Start
    Run::Step step{.accepted = iteration.step_is_successful};
    CeresPoint point = current_();
    step.objective = step.accepted ? point.objective : run_.summary().trace.back().minimised();
    return run_.Record(point.model, step) ? ceres::SOLVER_CONTINUE
                                          : ceres::SOLVER_TERMINATE_SUCCESSFULLY;
  }

 private:
  const std::function<CeresPoint()>& current_;
  Run& run_;
};

ceres::LinearSolverType TypeOf(LinearSolver linear_solver) {
  switch (linear_solver) {
    case LinearSolver::kDenseQr:
      return ceres::DENSE_QR;
    case LinearSolver::kDenseNormalCholesky:
      return ceres::DENSE_NORMAL_CHOLESKY;
    case LinearSolver::kAuto:
    case LinearSolver::kSparseNormalCholesky:
      return ceres::SPARSE_NORMAL_CHOLESKY;
    case LinearSolver::kDenseSchur:
      return ceres::DENSE_SCHUR;
    case LinearSolver::kSparseSchur:
      return ceres::SPARSE_SCHUR;
    case LinearSolver::kIterativeSchur:
      return ceres::ITERATIVE_SCHUR;
    case LinearSolver::kCgnr:
      return ceres::CGNR;
  }
  return ceres::SPARSE_NORMAL_CHOLESKY;
}

// The power of two next to the root of the mean of squares.
double Unit(double sum_of_squares, double total_weight) {
  const double mean_square = sum_of_squares / total_weight;
  return mean_square > 0 ? std::exp2(std::ilogb(std::sqrt(mean_square))) : 1;
}

double ValueUnit(const Objective& objective) {
  double weight = 0;
  for (int c = 0; c < kChannels; ++c) weight += objective.coverage()[c];  // of d
  return Unit(objective.MeasuredEnergy(), weight);
}

}  // namespace

ceres::Solver::Options CeresOptions(const SolverOptions& options, LinearSolver linear_solver,
                                    int num_threads) {
  ceres::Solver::Options ceres_options;
  ceres_options.trust_region_strategy_type =
      options.trust_region == TrustRegion::kDogleg ? ceres::DOGLEG : ceres::LEVENBERG_MARQUARDT;
  ceres_options.use_nonmonotonic_steps = options.nonmonotonic;
  ceres_options.linear_solver_type = TypeOf(linear_solver);
  // The diagonal blocks of the Schur complement cost next to nothing once it is there by blocks.
  ceres_options.preconditioner_type =
      linear_solver == LinearSolver::kIterativeSchur ? ceres::SCHUR_JACOBI : ceres::JACOBI;
  ceres_options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  ceres_options.dense_linear_algebra_library_type =
      ceres::LAPACK;  // as fast as the BLAS that is installed
  // Ceres would take no more, and say so on stderr.
  const int most_threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  ceres_options.num_threads = std::min(num_threads, most_threads);

  // Scale can move between the factors, so J'J is singular, and only the damping makes its
  // factorisation succeed. It must stay above the rounding errors of J'J.
  ceres_options.max_trust_region_radius = 1e10;
  // Only with bounds is there a line search. By bisection a trial costs one evaluation of the
  // residuals, not of the Jacobian. On synthetic plastic, aluminium and felt, 40 iterations with
  // it, and with Ceres' default of 1e4 for the initial radius, end no higher than with any other
  // choice.
  ceres_options.line_search_interpolation_type = ceres::BISECTION;

  // Run decides when to stop.
  ceres_options.max_num_iterations = options.max_iterations;
  ceres_options.function_tolerance = ceres_options.gradient_tolerance =
      ceres_options.parameter_tolerance = 0;

  ceres_options.update_state_every_iteration = true;
  ceres_options.logging_type = ceres::SILENT;
  std::string reason;
  if (!ceres_options.IsValid(&reason)) {
    throw Error(ErrorKind::kConflict, "Ceres does not take linear_solver " +
                                          std::string(LinearSolverName(linear_solver)) +
                                          " with trust_region " +
                                          TrustRegionName(options.trust_region) + ": " + reason)
        .About("linear_solver", LinearSolverName(linear_solver));
  }
  return ceres_options;
}

CeresParameters::CeresParameters(const Objective& objective, FactorModel start)
    : objective_(objective),
      start_(std::move(start)),
      value_unit_(ValueUnit(objective)),
      residual_unit_(Unit(objective.MeasuredEnergy(), kChannels * objective.num_samples())) {}

FactorModel CeresParameters::Scaled(FactorModel model, double by) const {
  for (double& d : model.d()) d *= by;
  for (int m = 0; m < model.spec().lobes; ++m) {
    for (double& s : model.s(m)) s *= by;
  }
  return model;
}

FactorModel CeresParameters::Start() const { return Scaled(start_, 1 / value_unit_); }

FactorModel CeresParameters::Model(FactorModel p) const {
  FactorModel model = Scaled(std::move(p), value_unit_);
  CopyUnobservedParameters(objective_.coverage(), start_, &model);
  return model;
}

void CeresParameters::SetBounds(std::span<double> block, ceres::Problem* problem) const {
  for (int k = 0; k < static_cast<int>(block.size()); ++k) {
    problem->SetParameterLowerBound(block.data(), k, 0);
    problem->SetParameterUpperBound(block.data(), k, std::max(block[k], kMaxParameter));
  }
}

ceres::Solver::Summary MinimizeWithCeres(ceres::Solver::Options options,
                                         const std::function<CeresPoint()>& current,
                                         ceres::Problem* problem, Run* run) {
  Recorder recorder(current, run);
  options.callbacks.push_back(&recorder);

  ceres::Solver::Summary summary;
  { const BlasCall memory_is_there; }  // or throws here; Ceres' own calls would try for ever
  try {
    ceres::Solve(options, problem, &summary);
  } catch (const std::system_error&) {  // Ceres starts its threads before all else, and got fewer
    if (options.num_threads == 1) throw;
    options.num_threads = 1;
    ceres::Solve(options, problem, &summary);
  }
  if (!run->stopped()) {
    run->summary().notes.push_back("Ceres: " + summary.message);
    run->Stop(StopReason::kNoDecrease);
  }
  PhaseSeconds& phases = run->summary().phases;
  phases.preparing += summary.preprocessor_time_in_seconds;
  phases.evaluating +=
      summary.residual_evaluation_time_in_seconds + summary.jacobian_evaluation_time_in_seconds;
  phases.linear_algebra += summary.linear_solver_time_in_seconds;
  return summary;
}

}  // namespace trilobe
