#include <optional>
#include <string>

#include "fit/reports/csv.h"
#include "fit/reports/study.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
std::string RunsCsv(std::span<const StudyRun> runs) {
  Csv csv(
      "problem,method,start,objective,excess,relative_objective,noise_objective,iterations,seconds,"
      "seconds_to_1_percent,stop_reason,optimality,raised,largest_rise,lobe_agreement,psnr_db,"
      "mean_delta_e,held_out_relative_objective,held_out_mean_delta_e,samples,parameters,folder,"
      "error");
  for (const StudyRun& run : runs) {
    const auto counted = [&](int n) { return run.failed() ? std::string() : std::to_string(n); };
    const SolverSummary::Raises raises = SolverSummary::FindRaises(run.trace);
    csv.Add(run.problem).Add(run.method).Add(run.start);
    csv.Add(run.objective()).Add(run.excess()).Add(run.relative_E).Add(run.noise_E);
    csv.Add(run.iterations()).Add(run.seconds).Add(run.SecondsTo(kAsGood));
    csv.Add(run.stop_reason).Add(run.optimality);
    csv.Add(raises.iterations.size()).Add(raises.largest).Add(run.agreement());
    csv.Add(run.psnr_db).Add(run.mean_delta_e).Add(run.held_out_E).Add(run.held_out_delta_e);
    csv.Add(counted(run.samples)).Add(counted(run.parameters)).Add(run.folder).Add(run.error);
    csv.EndRow();
  }
  return csv.text();
}

std::string MethodsCsv(std::span<const MethodSummary> summaries) {
  Csv csv(
      "problem,method,runs,failed,lowest_excess,median_excess,highest_excess,within_1_percent,"
      "within_1_percent_low,within_1_percent_high,within_0.1_percent,seconds,"
      "seconds_to_1_percent,expected_seconds_to_1_percent,iterations,endings,largest_optimality,"
      "raised,largest_rise,same_lobes_as_lowest,same_lobes_as_own_lowest,lobe_agreement,"
      "relative_objective,held_out_relative_objective,held_out_mean_delta_e,psnr_db,mean_delta_e,"
      "not_seen,parameters");
  for (const MethodSummary& of : summaries) {
    csv.Add(of.problem).Add(of.method).Add(of.runs).Add(of.failed);
    csv.Add(of.lowest).Add(of.median).Add(of.highest);
    csv.Add(of.as_good.value()).Add(of.as_good.low()).Add(of.as_good.high());
    csv.Add(of.the_same.value()).Add(of.seconds).Add(of.seconds_to_as_good);
    csv.Add(of.expected_seconds).Add(of.iterations).Add(EndingsText(of)).Add(of.optimality);
    csv.Add(of.raised).Add(of.largest_rise);
    csv.Add(of.same_lobes.value()).Add(of.same_as_own.value()).Add(of.agreement);
    csv.Add(of.relative_E).Add(of.held_out_E).Add(of.held_out_delta_e);
    csv.Add(of.psnr_db).Add(of.mean_delta_e).Add(of.unseen.value()).Add(of.parameters);
    csv.EndRow();
  }
  return csv.text();
}

std::string TracesCsv(std::span<const StudyRun> runs) {
  Csv csv("problem,method,start,iteration,seconds,objective");
  for (const StudyRun& run : runs) {
    for (const IterationRecord& record : run.trace) {
      csv.Add(run.problem).Add(run.method).Add(run.start);
      csv.Add(record.iteration).Add(record.seconds).Add(record.minimised());
      csv.EndRow();
    }
  }
  return csv.text();
}

}  // namespace trilobe
