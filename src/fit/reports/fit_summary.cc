#include "fit/reports/fit_summary.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>
#include <utility>

#include "fit/reports/appearance_report.h"
#include "fit/reports/print.h"

namespace trilobe {
namespace {

std::string EndText(StopReason reason) {
  switch (reason) {
    case StopReason::kConverged:
      return "converged";
    case StopReason::kOptimal:
      return "at a minimum";
    case StopReason::kExactFit:
      return "exact";
    case StopReason::kNoDecrease:
      return "no step lowers E any more";
    case StopReason::kMaxIterations:
      return "stopped by --max_iterations";
    case StopReason::kMaxSeconds:
      return "stopped by --max_seconds";
    case StopReason::kInterrupted:
      return "interrupted";
  }
  return "";
}

std::string FormText(const FitReport& report) {
  std::string text = std::to_string(report.spec.lobes) +
                     (report.spec.lobes == 1 ? " lobe of " : " lobes of ") + ParametersText(report);
  const FitReport::Finished& finished = report.finished;
  if (finished.chosen < 0) return text;
  return text + ", the best of " + std::to_string(finished.candidates.size()) + " forms (" +
         finished.candidates[finished.chosen].name + ")";
}

std::string Hundredths(double seconds) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.2f", seconds);
  return text;
}

}  // namespace

void PrintSummary(const FitReport& report) {
  const FitInfo& fit = report.fit;
  const SolverSummary& summary = report.summary;
  std::cout << Describe(VerdictOn(report));
  PrintLine("fitted       " + fit.source + ", " + std::to_string(fit.valid_samples) +
            " samples up to " + Text(fit.max_angle) + " deg, by " + FormText(report));
  std::cout << "solver       " << summary.solver << ": " << summary.iterations << " iterations, "
            << EndText(summary.stop_reason) << "; E is "
            << Text(100 * report.score.relative_objective, 3) << " % of a black model's\n";
  if (report.finished.too_few_to_choose > 0) {
    PrintLine("note         no form was chosen, which takes " +
              std::to_string(report.finished.too_few_to_choose) +
              " samples or more; this is the default form");
  }
  if (report.appearance) std::cout << DescribeBriefly(*report.appearance);
  if (report.reach) std::cout << ReachText(*report.reach);
}

void PrintSeconds(const FitReport& report) {
  const FitReport::Seconds& seconds = report.seconds;
  double total = 0;
  std::string parts;
  for (const auto& [name, part] : {std::pair{"reading", seconds.read},
                                   {"preparing", seconds.prepare},
                                   {"starting", seconds.init},
                                   {"choosing nodes", seconds.nodes},
                                   {"solving", seconds.solve},
                                   {"finishing", seconds.finish},
                                   {"comparing", seconds.score},
                                   {"drawing", seconds.draw}}) {
    // Rounded before they are summed, so that what is printed adds up.
    const double rounded = std::round(100 * part) / 100;
    total += rounded;
    if (rounded > 0) parts += (parts.empty() ? "" : ", ") + Hundredths(rounded) + " " + name;
  }
  std::cout << "seconds      " << Hundredths(total) << (parts.empty() ? "" : ": ") << parts << "\n";
}

}  // namespace trilobe
