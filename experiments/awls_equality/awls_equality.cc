// Do the fast and the reference AWLS make the same sweeps? See README.md beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "experiments/program.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

DEFINE_int32(sweeps, 20, "sweeps to compare");
DEFINE_int32(stride, 1, "of each (theta_h, theta_d) every stride-th phi_d is kept");
DEFINE_double(noise, 0.02, "relative noise of synth: sources");
DEFINE_string(weighting, "compressive", "weights of the objective");
DEFINE_bool(extrapolated, false, "of an RGL file, also take what was extrapolated");
DEFINE_double(max_angle, 90, "leave out bins whose theta_i or theta_o is beyond this, in degrees");
DEFINE_double(limit, 1e-9, "largest relative difference of E to pass");

namespace trilobe {
namespace {

SolverSummary Sweeps(const std::string& solver, const Objective& objective, double g_filter_sigma) {
  FactorModel model = InitialModels().front().make(objective, 1);
  SolverOptions options;
  options.max_iterations = FLAGS_sweeps;
  options.relative_decrease_tolerance = 0;
  options.g_filter_sigma = g_filter_sigma;
  return MakeSolver(solver)->Solve(objective, options, &model);
}

// Prints a row of CSV; true if E was the same after every sweep.
bool Compare(const Objective& objective, double g_filter_sigma) {
  const SolverSummary fast = Sweeps("awls", objective, g_filter_sigma);
  const SolverSummary reference = Sweeps("awls_literal", objective, g_filter_sigma);
  double worst = 0;
  bool passed = fast.trace.size() == reference.trace.size();
  for (size_t k = 0; k < std::min(fast.trace.size(), reference.trace.size()); ++k) {
    const double expected = reference.trace[k].objective;
    const double difference = std::abs(fast.trace[k].objective - expected);
    passed &= difference <= FLAGS_limit * expected;  // false for NaN
    worst = std::max(worst, difference / expected);
  }
  const auto seconds_per_sweep = [](const SolverSummary& summary) {
    return (summary.trace.back().seconds - summary.trace.front().seconds) / summary.iterations;
  };
  std::printf("%g,%d,%.10g,%.10g,%.2g,%.3g,%.3g\n", g_filter_sigma, fast.iterations,
              fast.initial_objective, fast.final_objective, worst, seconds_per_sweep(reference),
              seconds_per_sweep(fast));
  return passed;
}

int Main(const std::string& source) {
  std::printf(
      "filter,sweeps,first_E,best_E,worst_relative_difference,literal_s_a_sweep,awls_s_a_sweep\n");
  const SourceOptions options = {
      .noise = FLAGS_noise, .max_angle_deg = FLAGS_max_angle, .extrapolated = FLAGS_extrapolated};
  const BrdfSamples samples = Thinned(ValidSamples(LoadTable(source, options)), FLAGS_stride);
  const Objective objective(samples, ModelSpec::SharedFactors(3, samples.grid),
                            FindWeighting(FLAGS_weighting));
  bool passed = true;
  for (const double sigma : {0.0, 1.0}) passed &= Compare(objective, sigma);
  if (!passed) {
    std::fprintf(stderr, "awls_equality: E differs by more than %g of it\n", FLAGS_limit);
  }
  return passed ? 0 : 1;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "awls_equality SOURCE", 1,
                              [](auto words) { return trilobe::Main(words[0]); });
}
