#include "trilobe/solvers/sweeps.h"

#include <cmath>
#include <limits>
#include <optional>

#include "trilobe/solvers/gaussian_filter.h"

namespace trilobe {
namespace {

// E of a model whose every value is off by a few rounding errors of the measured one.
double RoundingFloor(const Objective& objective) {
  constexpr double kError = 4 * std::numeric_limits<double>::epsilon();
  return kError * kError * objective.MeasuredEnergy();
}

std::optional<StopReason> ReasonToStop(const SolverOptions& options, double floor,
                                       const std::vector<IterationRecord>& trace) {
  const IterationRecord& last = trace.back();
  if (last.objective <= floor) return StopReason::kExactFit;
  if (trace.size() > 1) {
    const double before = trace[trace.size() - 2].objective;
    // Absolute: a rise by the filter is no sign of convergence.
    if (std::abs(before - last.objective) < options.relative_decrease_tolerance * before) {
      return StopReason::kConverged;
    }
  }
  if (last.iteration >= options.max_iterations) return StopReason::kMaxIterations;
  if (last.seconds >= options.max_seconds) return StopReason::kMaxSeconds;
  return std::nullopt;
}

}  // namespace

SolverSummary RunSweeps(const std::string& solver, const Objective& objective,
                        const SolverOptions& options,
                        const std::function<void(FactorModel*)>& sweep,
                        std::chrono::steady_clock::time_point start, FactorModel* model) {
  SolverSummary summary;
  summary.solver = solver;
  const double floor = RoundingFloor(objective);
  FactorModel current = *model;
  // Appends a record of `current`; false when it is time to stop.
  const auto record = [&](int iteration, bool filtered) {
    const double objective_value = objective.Value(current);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    summary.trace.push_back({iteration, elapsed.count(), objective_value, filtered});
    if (iteration == 0 || objective_value < summary.final_objective) {
      summary.final_objective = objective_value;
      *model = current;
    }
    std::optional<StopReason> reason = ReasonToStop(options, floor, summary.trace);
    if (options.on_iteration && !options.on_iteration(summary.trace.back(), current)) {
      reason = reason.value_or(StopReason::kInterrupted);
    }
    summary.stop_reason = reason.value_or(StopReason::kMaxIterations);
    return !reason.has_value();
  };

  for (bool go_on = record(0, false); go_on;) {
    sweep(&current);
    const bool filter = options.g_filter_sigma > 0;
    if (filter) SmoothG(options.g_filter_sigma, objective.coverage(), &current);
    go_on = record(++summary.iterations, filter);
  }
  summary.initial_objective = summary.trace.front().objective;
  summary.seconds = summary.trace.back().seconds;
  return summary;
}

}  // namespace trilobe
