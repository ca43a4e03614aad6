// What the fast solvers gain on an anisotropic measurement of UTIA's size, 82,944 directions in
// three channels, by a model of 2,010 parameters: iterations of pairs of solvers, in one run, in
// processor time.
//
//   build/release/benchmarks/anisotropic_benchmark
//
// The measurement is synth:charmeuse with 2 % noise, or what the environment variable
// TRILOBE_BENCHMARK_SOURCE names.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

// Many of a fast solver, whose first ones are slower than the rest.
constexpr int kIterations = 8, kFastIterations = 40;

const Objective& FullSize(int num_threads) {
  static const BrdfSamples samples = [] {
    const char* const source = std::getenv("TRILOBE_BENCHMARK_SOURCE");
    return SamplesOf(
        LoadMeasurement(source != nullptr ? source : "synth:charmeuse", {.noise = 0.02}));
  }();
  static const Objective objective(samples, ModelSpec::Anisotropic(3), FindWeighting("appearance"),
                                   num_threads);
  return objective;
}

// Processor seconds of an iteration, E for the trace included: the median of so many, without the
// first, which has preparations in it.
double SecondsOfAnIteration(const char* solver, int iterations, const Objective& objective) {
  FactorModel model = FindInitialModel("analytic").make(objective, 1);
  std::vector<std::clock_t> at;
  SolverOptions options{.max_iterations = iterations,
                        .relative_decrease_tolerance = 0,
                        .optimality_tolerance = 0,
                        .diagnose = false};
  options.on_iteration = [&](const IterationRecord&, const FactorModel&) {
    at.push_back(std::clock());
    return true;
  };
  MakeSolver(solver)->Solve(objective, options, &model);
  std::vector<std::clock_t> times;
  for (size_t k = 2; k < at.size(); ++k) times.push_back(at[k] - at[k - 1]);
  std::ranges::sort(times);
  return static_cast<double>(times[times.size() / 2]) / CLOCKS_PER_SEC;
}

void Compare(benchmark::State& state, const char* fast, int fast_iterations,
             const char* reference) {
  const Objective& objective = FullSize(/*num_threads=*/2);
  for (auto _ : state) {
    const double of_fast = SecondsOfAnIteration(fast, fast_iterations, objective);
    const double of_reference = SecondsOfAnIteration(reference, kIterations, objective);
    state.counters[fast] = of_fast;
    state.counters[reference] = of_reference;
    state.counters["ratio"] = of_reference / of_fast;
  }
  state.counters["samples"] = objective.samples().size();
  state.counters["parameters"] = objective.spec().num_parameters();
}

void BM_Sweep(benchmark::State& state) { Compare(state, "awls", kFastIterations, "awls_literal"); }
void BM_LevenbergMarquardt(benchmark::State& state) {
  Compare(state, "lm", kIterations, "lm_plain");
}
void BM_Newton(benchmark::State& state) { Compare(state, "newton", kIterations, "lm_plain"); }

BENCHMARK(BM_Sweep)->Unit(benchmark::kSecond)->Iterations(1);
BENCHMARK(BM_LevenbergMarquardt)->Unit(benchmark::kSecond)->Iterations(1);
BENCHMARK(BM_Newton)->Unit(benchmark::kSecond)->Iterations(1);

}  // namespace
}  // namespace trilobe

BENCHMARK_MAIN();
