// Do the fast and the literal AWLS make the same sweeps? See README.md beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "trilobe/io/source.h"
#include "trilobe/model/objective.h"
#include "trilobe/solvers/initial_model.h"
#include "trilobe/solvers/solver.h"

DEFINE_bool(quick, false, "keep one bin in 50 and make 5 sweeps");
DEFINE_int32(sweeps, 20, "sweeps to compare");
DEFINE_double(noise, 0.02, "relative noise of synth: sources");
DEFINE_double(limit, 1e-9, "largest relative difference of E to pass");

namespace trilobe {
namespace {

SolverSummary Sweeps(const std::string& solver, const Objective& objective, double g_filter_sigma) {
  FactorModel model = InitialModels().front().make(objective, 1);
  SolverOptions options;
  options.max_iterations = FLAGS_quick ? std::min(5, FLAGS_sweeps) : FLAGS_sweeps;
  options.relative_decrease_tolerance = 0;
  options.g_filter_sigma = g_filter_sigma;
  return MakeSolver(solver)->Solve(objective, options, &model);
}

// Prints a row of the table; true if E was the same after every sweep.
bool Compare(const std::string& source, const Objective& objective, double g_filter_sigma) {
  const SolverSummary fast = Sweeps("awls", objective, g_filter_sigma);
  const SolverSummary literal = Sweeps("awls_literal", objective, g_filter_sigma);
  double worst = 0;
  bool passed = fast.trace.size() == literal.trace.size();
  for (size_t k = 0; k < std::min(fast.trace.size(), literal.trace.size()); ++k) {
    const double expected = literal.trace[k].objective;
    const double difference = std::abs(fast.trace[k].objective - expected);
    passed &= difference <= FLAGS_limit * expected;  // false for NaN
    worst = std::max(worst, difference / expected);
  }
  const auto seconds_per_sweep = [](const SolverSummary& summary) {
    return (summary.trace.back().seconds - summary.trace.front().seconds) / summary.iterations;
  };
  std::printf("| %s | %g | %d | %.6g | %.6g | %.1e | %.2f | %.4f |\n", source.c_str(),
              g_filter_sigma, fast.iterations, fast.initial_objective, fast.final_objective, worst,
              seconds_per_sweep(literal), seconds_per_sweep(fast));
  std::fflush(stdout);
  return passed;
}

int Main(const std::vector<std::string>& sources) {
  std::printf(
      "| material | filter | sweeps | first E | best E | worst relative difference | literal "
      "s/sweep | awls s/sweep |\n|---|---|---|---|---|---|---|---|\n");
  bool passed = true;
  for (const std::string& source : sources) {
    BrdfSamples samples = ValidSamples(LoadSource(source, {.noise = FLAGS_noise}));
    if (FLAGS_quick) {
      BrdfSamples thin{samples.source, samples.grid, {}, {}, {}};
      for (int j = 0; j < samples.size(); j += 50) {
        thin.bins.push_back(samples.bins[j]);
        thin.rho.push_back(samples.rho[j]);
      }
      samples = thin;
    }
    const Objective objective(samples, ModelSpec::SharedFactors(3), Weightings().front());
    for (const double sigma : {0.0, 1.0}) passed &= Compare(source, objective, sigma);
  }
  return passed ? 0 : 1;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  gflags::SetUsageMessage("awls_equality [--quick] [SOURCE ...]");
  gflags::ParseCommandLineFlags(&argc, &argv, true);
  std::vector<std::string> sources(argv + 1, argv + argc);
  if (sources.empty()) sources = {"synth:plastic", "synth:felt", "synth:chrome"};
  try {
    return trilobe::Main(sources);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "awls_equality: error: %s\n", error.what());
    return 1;
  }
}
