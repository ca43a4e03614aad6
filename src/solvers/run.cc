#include "trilobe/solvers/run.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "core/system/process.h"
#include "solvers/diagnosis.h"
#include "solvers/gaussian_filter.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// |a - b| / |b|, scaled against overflow.
double RelativeDistance(std::span<const double> a, std::span<const double> b) {
  double largest = 0;
  for (const double x : b) largest = std::max(largest, std::abs(x));
  if (largest == 0) return std::ranges::equal(a, b) ? 0 : 1;
  double distance = 0, norm = 0;
  for (size_t k = 0; k < a.size(); ++k) {
    distance = std::hypot(distance, a[k] / largest - b[k] / largest);
    norm = std::hypot(norm, b[k] / largest);
  }
  return distance / norm;
}

SolverOptions WithoutCallbacks(SolverOptions options) {
  options.on_iteration = nullptr;
  options.on_start = nullptr;
  options.on_element = nullptr;
  options.stop = nullptr;
  return options;
}

}  // namespace

double ExactObjective(const Objective& objective) {
  constexpr double kError = 4 * std::numeric_limits<double>::epsilon();
  return kError * kError * objective.MeasuredEnergy();
}

Run::Run(std::string solver, const Objective& objective, const SolverOptions& options,
         FactorModel* model)
    : objective_(objective),
      exact_objective_(ExactObjective(objective)),
      model_(model),
      previous_(NotNull(model, "the model")) {
  summary_.solver = std::move(solver);
  summary_.given = WithoutCallbacks(options);
  summary_.used = options;
}

double Run::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

bool Run::IsToStop() const {
  const SolverOptions& options = summary_.used;
  return (options.stop && options.stop()) || seconds() >= options.max_seconds;
}

std::optional<StopReason> Run::ReasonToStop(bool may_converge) const {
  const SolverOptions& options = summary_.used;
  const IterationRecord& last = summary_.trace.back();
  if (last.minimised() <= exact_objective_) return StopReason::kExactFit;
  if (last.optimality && *last.optimality <= options.optimality_tolerance) {
    return StopReason::kOptimal;
  }
  if (may_converge && summary_.trace.size() > 1 && last.accepted) {
    const double before = summary_.trace[summary_.trace.size() - 2].minimised();
    // Absolute: a rise by the filter is no sign of convergence.
    if (std::abs(before - last.minimised()) < options.relative_decrease_tolerance * before) {
      return StopReason::kConverged;
    }
  }
  if (last.iteration >= options.max_iterations) return StopReason::kMaxIterations;
  if (last.seconds >= options.max_seconds) return StopReason::kMaxSeconds;
  return std::nullopt;
}

bool Run::Start(std::optional<double> optimality) {
  return Record(previous_, {.optimality = optimality});
}

bool Run::Record(const FactorModel& current, const Step& step) {
  IterationRecord record;
  record.iteration = static_cast<int>(summary_.trace.size());
  if (step.objective) {
    record.objective = *step.objective;
  } else {
    const ScopedTimer timer = Time(&PhaseSeconds::tracing);
    record.objective = objective_.Value(current);
  }
  if (objective_.has_prior()) {
    const ScopedTimer timer = Time(&PhaseSeconds::tracing);
    record.objective_with_prior = record.objective;
    record.objective = objective_.data().Value(current);
  }
  if (record.iteration == 0 && !std::isfinite(record.minimised())) {
    throw ErrorIn(ErrorKind::kData, objective_.samples().source,
                  "E overflows at the starting model; its factors are too large")
        .About("model", "overflow");
  }
  record.seconds = seconds();
  record.processor_seconds = ProcessorSeconds();
  record.filtered = step.filtered;
  record.accepted = step.accepted;
  record.step = RelativeDistance(current.parameters(), previous_.parameters());
  record.optimality = step.optimality;
  summary_.trace.push_back(record);
  if (record.iteration == 0 || record.minimised() < best_objective_) {
    best_objective_ = record.minimised();
    summary_.final_objective = record.objective;
    *model_ = current;
  }
  VLOG(1) << summary_.solver << " " << record.iteration << ": E " << record.minimised()
          << ", moved by " << record.step << (record.accepted ? "" : ", taken back") << ", after "
          << record.seconds << " s";
  previous_ = current;
  if (!reason_) reason_ = ReasonToStop(step.may_converge);
  const auto& [on_iteration, stop] = std::tie(summary_.used.on_iteration, summary_.used.stop);
  if ((on_iteration && !on_iteration(record, current)) || (stop && stop())) {
    Stop(StopReason::kInterrupted);
  }
  return !reason_;
}

void Run::Stop(StopReason reason) { reason_ = reason_.value_or(reason); }

SolverSummary Run::Finish() {
  summary_.stop_reason = reason_.value_or(StopReason::kMaxIterations);
  summary_.initial_objective = summary_.trace.front().objective;
  summary_.iterations = summary_.trace.back().iteration;
  summary_.seconds = summary_.trace.back().seconds;
  VLOG(1) << summary_.solver << " ended: " << StopReasonName(summary_.stop_reason) << ", E "
          << best_objective_;
  // Users who interrupt a run do not wait for the diagnosis.
  if (summary_.used.diagnose && reason_ != StopReason::kInterrupted) {
    const ScopedTimer timer = Time(&PhaseSeconds::diagnosing);
    summary_.diagnosis = Diagnose(objective_, *model_);
    if (auto warning = ConditionWarning(objective_, *summary_.diagnosis)) {
      summary_.notes.push_back(*std::move(warning));
    }
  }
  summary_.used = WithoutCallbacks(summary_.used);
  return std::move(summary_);
}

void RepeatSweeps(const std::function<void(FactorModel*)>& sweep, const Objective& objective,
                  FactorModel current, Run* run) {
  CheckNotEmpty(sweep, "sweep");
  const double sigma = NotNull(run, "the run").options().g_filter_sigma;
  for (bool go_on = run->Start(); go_on;) {
    sweep(&current);
    if (sigma > 0) SmoothG(sigma, objective.coverage(), &current);
    go_on = run->Record(current, {.filtered = sigma > 0});
  }
}

}  // namespace trilobe
