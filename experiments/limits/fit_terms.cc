#include <algorithm>
#include <limits>
#include <utility>

#include "experiments/limits/term_problem.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/nonnegative_step.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Entries that no sample reads have no column in J.
void CarryUnread(std::span<const double> squared_lengths, const TermModel& start,
                 TermModel* model) {
  const std::span<double> x = model->parameters();
  const std::span<const double> x0 = start.parameters();
  for (const auto& [begin, size] : model->Parts()) {
    std::vector<int> read;
    for (int k = begin; k < begin + size; ++k) {
      if (squared_lengths[k] > 0) read.push_back(k);
    }
    if (read.empty()) continue;
    for (int k = begin; k < begin + size; ++k) {
      const auto after = std::ranges::lower_bound(read, k);
      if (after != read.end() && *after == k) continue;
      int nearest = after == read.end() ? read.back() : *after;
      if (after != read.end() && after != read.begin() && k - *(after - 1) <= *after - k) {
        nearest = *(after - 1);
      }
      if (x0[nearest] > 0) x[k] *= x[nearest] / x0[nearest];
    }
  }
}

}  // namespace

TermFit FitTerms(const TermProblem& problem, const TermModel& start,
                 const TermFitOptions& options) {
  constexpr double kLeast = 1e-9, kMost = 1e8, kFirst = 1e-3, kRounding = 1e-14;
  double lambda = kFirst;
  TermFit fit{.model = start, .trace = {problem.Value(start)}};
  const std::vector<FactorModel::Part> parts = start.Parts();
  QuadraticModel at;
  std::vector<double> first_lengths;
  NonnegativeStep step;
  while (static_cast<int>(fit.trace.size()) <= options.max_steps && !fit.converged &&
         !options.stop()) {
    problem.Linearize(fit.model, &at);
    if (first_lengths.empty()) first_lengths = at.squared_lengths;
    const std::vector<double> metric = DampingMetric(parts, at.squared_lengths);
    step.MoveTo(at, metric, fit.model.parameters());
    const double E = fit.trace.back();
    double lower = E;
    for (; !(lower < E) && lambda < kMost; lambda *= 4) {
      const NonnegativeStep::Result tried = step.Solve(lambda);
      TermModel there = fit.model;
      std::ranges::copy(tried.x, there.parameters().begin());
      const double value = problem.Value(there);
      if (!(value < E)) continue;
      lower = value;
      fit.model = std::move(there);
    }
    lambda = std::max(lambda / 20, kLeast);  // a fifth of the one that was taken
    fit.trace.push_back(lower);
    fit.converged = !(E - lower > options.tolerance * E + kRounding * problem.MeasuredEnergy());
    if (options.on_step) options.on_step(static_cast<int>(fit.trace.size()) - 1, lower);
  }
  if (!first_lengths.empty()) CarryUnread(first_lengths, start, &fit.model);
  return fit;
}

}  // namespace trilobe
