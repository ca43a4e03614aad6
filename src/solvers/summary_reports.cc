// Reports of a SolverSummary for people.

#include <algorithm>
#include <iomanip>
#include <sstream>

#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

// "memory 3 (given 5), seed 1"
std::string OptionsText(const SolverSummary& summary) {
  std::string text;
  for (const SolverOption* option : OptionsReadBy(summary.own_options)) {
    const OptionValue given = option->get(summary.given), used = option->get(summary.used);
    text += (text.empty() ? "" : ", ") + option->name + " " + ToText(used);
    if (used != given) text += " (given " + ToText(given) + ")";
  }
  return text;
}

}  // namespace

PhaseSeconds& PhaseSeconds::operator+=(const PhaseSeconds& other) {
  reading += other.reading;
  preparing += other.preparing;
  evaluating += other.evaluating;
  tracing += other.tracing;
  linear_algebra += other.linear_algebra;
  diagnosing += other.diagnosing;
  return *this;
}

int SolverSummary::BestIteration() const {
  if (trace.empty()) return 0;
  return std::ranges::min_element(trace, {}, &IterationRecord::minimised)->iteration;
}

int SolverSummary::RejectedSteps() const {
  return static_cast<int>(std::ranges::count(trace, false, &IterationRecord::accepted));
}

SolverSummary::Raises SolverSummary::FindRaises(std::span<const IterationRecord> trace) {
  constexpr double kRounding = 1e-12;
  Raises raises;
  for (size_t k = 1; k < trace.size(); ++k) {
    const double before = trace[k - 1].minimised(), after = trace[k].minimised();
    if (after <= before * (1 + kRounding)) continue;
    raises.iterations.push_back(trace[k].iteration);
    raises.largest = std::max(raises.largest, before > 0 ? after / before - 1 : 0);
  }
  return raises;
}

std::string SolverSummary::BriefReport() const {
  std::ostringstream out;
  out << solver << ": " << iterations << " iterations in " << seconds << " s, E from "
      << initial_objective << " to " << final_objective;
  if (has_prior()) {
    out << " (with the prior " << trace.front().minimised() << " to "
        << trace[BestIteration()].minimised() << ")";
  }
  out << ", stopped by " << StopReasonName(stop_reason);
  return out.str();
}

std::string SolverSummary::FullReport() const {
  std::ostringstream out;
  out << std::setprecision(6) << "solver       " << solver << ": " << iterations
      << " iterations, stopped by " << StopReasonName(stop_reason) << "\n"
      << "objective    E " << initial_objective << " -> " << final_objective;
  if (!trace.empty()) {
    out << ", lowest after iteration " << BestIteration();
    if (RejectedSteps() > 0) out << ", " << RejectedSteps() << " steps taken back";
    out << std::setprecision(3) << ", last step " << trace.back().step << " of |x|";
  }
  if (const Raises raises = FindRaises(); !raises.iterations.empty()) {
    out << "\nraised E     in " << raises.iterations.size() << " of " << trace.size() - 1
        << " iterations, first in " << raises.iterations.front() << ", by up to "
        << 100 * raises.largest << " %" << std::setprecision(6);
  }
  if (has_prior()) {
    out << std::setprecision(6)
        << "\n             with the prior, which is what the solver lowers: E "
        << trace.front().minimised() << " -> " << trace[BestIteration()].minimised();
  }
  out << "\noptions      " << OptionsText(*this) << "\n";
  for (const std::string& note : notes) out << "note         " << note << "\n";
  for (size_t k = 0; k < starts.size(); ++k) {
    out << (k > 0         ? ", "
            : has_prior() ? "starts       E with the prior: "
                          : "starts       ")
        << starts[k].name << " " << starts[k].objective;
  }
  if (!starts.empty()) out << "\n";
  out << std::setprecision(3);
  if (diagnosis) {
    out << "diagnosis    optimality " << diagnosis->optimality << ", rank " << diagnosis->rank
        << " of " << diagnosis->observed_parameters
        << " observed parameters (singular values above " << diagnosis->rank_tolerance
        << " of the largest), condition " << diagnosis->condition << "\n";
  }
  out << "phases       ";
  if (phases.reading > 0) out << phases.reading << " s reading, ";
  out << seconds << " s solving (" << phases.preparing << " preparing, " << phases.evaluating
      << " evaluating, " << phases.tracing << " tracing, " << phases.linear_algebra
      << " linear algebra), " << phases.diagnosing << " s diagnosing\n";
  return out.str();
}

}  // namespace trilobe
