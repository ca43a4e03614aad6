// The cost of a fit on one full-size MERL material (1,096,216 bins above the surface, 822
// parameters).
//
//   build/release/benchmarks/fit_benchmark
//
// `threads` is the argument of each benchmark. The material is synth:plastic with 2 % noise, or the
// MERL file that the environment variable TRILOBE_BENCHMARK_SOURCE names.

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/files/file.h"
#include "io/formats/databases/merl_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {
namespace {

const BrdfTable& Measurement() {
  static const BrdfTable table = [] {
    const char* const source = std::getenv("TRILOBE_BENCHMARK_SOURCE");
    return LoadTable(source != nullptr ? source : "synth:plastic", {.noise = 0.02});
  }();
  return table;
}

Objective MakeObjective(int threads) {
  return Objective(ValidSamples(Measurement()), ModelSpec::SharedFactors(3),
                   FindWeighting("compressive"), threads);
}

// From a 35 MB file in the page cache to an objective.
void BM_ReadAndPrepare(benchmark::State& state) {
  const std::string path =
      (std::filesystem::temp_directory_path() / "trilobe_benchmark.binary").string();
  WriteMerl(Measurement(), path);
  for (auto _ : state) {
    const Objective objective(ValidSamples(ReadMerl(path)), ModelSpec::SharedFactors(3),
                              FindWeighting("compressive"), static_cast<int>(state.range(0)));
    benchmark::DoNotOptimize(objective.MeasuredEnergy());
  }
  std::filesystem::remove(path);
}

void BM_Value(benchmark::State& state) {
  const Objective objective = MakeObjective(static_cast<int>(state.range(0)));
  const FactorModel model = FindInitialModel("analytic").make(objective, 1);
  for (auto _ : state) benchmark::DoNotOptimize(objective.Value(model));
}

// The reference counterpart of BM_Value: every sample by its stencils.
void BM_ValueReference(benchmark::State& state) {
  const Objective objective = MakeObjective(static_cast<int>(state.range(0)));
  const FactorModel model = FindInitialModel("analytic").make(objective, 1);
  const std::vector<WeightedSample>& samples = objective.weighted_samples();
  for (auto _ : state) {
    double sum = 0;
    for (const WeightedSample& sample : samples) {
      for (int c = 0; c < kChannels; ++c) {
        const double residual = sample.rho[c] - UnclampedValue(model, sample.stencils, c);
        sum += sample.weight[c] * residual * residual;
      }
    }
    benchmark::DoNotOptimize(sum);
  }
}

// J'J, J'r and E: what one iteration of a joint solver asks of the data.
void Equations(benchmark::State& state, Hessian hessian) {
  const Objective objective = MakeObjective(static_cast<int>(state.range(0)));
  const FactorModel model = FindInitialModel("analytic").make(objective, 1);
  NormalEquations equations(objective);
  QuadraticModel result;
  for (auto _ : state) {
    equations.Evaluate(model, hessian, &result);
    benchmark::DoNotOptimize(result.objective);
  }
}

void BM_NormalEquations(benchmark::State& state) { Equations(state, Hessian::kGaussNewton); }
void BM_NewtonEquations(benchmark::State& state) { Equations(state, Hessian::kNewton); }

// The reference counterpart of the former: each sample's derivatives, multiplied out.
void BM_NormalEquationsReference(benchmark::State& state) {
  const Objective objective = MakeObjective(static_cast<int>(state.range(0)));
  const FactorModel model = FindInitialModel("analytic").make(objective, 1);
  objective.weighted_samples();
  QuadraticModel result;
  for (auto _ : state) {
    EvaluateReference(objective, model, Hessian::kGaussNewton, &result);
    benchmark::DoNotOptimize(result.objective);
  }
}

// An eighth of the samples, 137,027, as if they were on no grid.
Objective ScatteredObjective(int threads) {
  BrdfSamples samples = Thinned(ValidSamples(Measurement()), 8);
  for (const int bin : samples.bins) samples.angles.push_back(samples.grid.Center(bin));
  samples.bins.clear();
  return Objective(std::move(samples), ModelSpec::SharedFactors(3), FindWeighting("compressive"),
                   threads);
}

void BM_ScatteredNormalEquations(benchmark::State& state) {
  const Objective objective = ScatteredObjective(static_cast<int>(state.range(0)));
  const FactorModel model = FindInitialModel("analytic").make(objective, 1);
  NormalEquations equations(objective);
  QuadraticModel result;
  for (auto _ : state) {
    equations.Evaluate(model, Hessian::kGaussNewton, &result);
    benchmark::DoNotOptimize(result.objective);
  }
}
void BM_ScatteredNormalEquationsReference(benchmark::State& state) {
  const Objective objective = ScatteredObjective(static_cast<int>(state.range(0)));
  const FactorModel model = FindInitialModel("analytic").make(objective, 1);
  QuadraticModel result;
  for (auto _ : state) {
    EvaluateReference(objective, model, Hessian::kGaussNewton, &result);
    benchmark::DoNotOptimize(result.objective);
  }
}

// The median of the iterations that were accepted, E for the trace included. The solver's
// preparations are not, nor are steps taken back, after which the same derivatives serve again.
void Iteration(benchmark::State& state, const char* solver, int iterations,
               Objective (*make)(int) = MakeObjective) {
  const Objective objective = make(static_cast<int>(state.range(0)));
  SolverOptions options;
  options.max_iterations = iterations;
  options.relative_decrease_tolerance = 0;
  options.optimality_tolerance = 0;
  options.diagnose = false;
  for (auto _ : state) {
    FactorModel model = FindInitialModel("analytic").make(objective, 1);
    const SolverSummary summary = MakeSolver(solver)->Solve(objective, options, &model);
    std::vector<double> seconds;
    for (size_t k = 1; k < summary.trace.size(); ++k) {
      if (!summary.trace[k].accepted) continue;
      seconds.push_back(summary.trace[k].seconds - summary.trace[k - 1].seconds);
    }
    if (seconds.empty()) {
      state.SkipWithError("no iteration was accepted");
      break;
    }
    const auto middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
    std::ranges::nth_element(seconds, middle);
    state.SetIterationTime(*middle);
  }
}
void BM_AwlsSweep(benchmark::State& state) { Iteration(state, "awls", 20); }
void BM_AwlsReferenceSweep(benchmark::State& state) { Iteration(state, "awls_literal", 1); }
void BM_ScatteredSweep(benchmark::State& state) { Iteration(state, "awls", 5, ScatteredObjective); }
void BM_ScatteredSweepReference(benchmark::State& state) {
  Iteration(state, "awls_literal", 1, ScatteredObjective);
}
void BM_LmIteration(benchmark::State& state) { Iteration(state, "lm", 20); }
void BM_LmPlainIteration(benchmark::State& state) { Iteration(state, "lm_plain", 5); }

// The whole program, file to files, with a reconstruction: `trilobe fit`, by its defaults but for
// these flags. E must not depend on the number of threads.
void BM_Fit(benchmark::State& state, const std::vector<std::string>& flags) {
  const auto folder = std::filesystem::temp_directory_path() / "trilobe_benchmark_fit";
  std::filesystem::create_directories(folder);
  const std::string source = folder / "source.binary";
  WriteMerl(Measurement(), source);
  std::vector<std::string> words = {TRILOBE_PROGRAM,
                                    "fit",
                                    source,
                                    "--reconstruction",
                                    "--threads=" + std::to_string(state.range(0)),
                                    "--out=" + folder.string()};
  words.insert(words.end(), flags.begin(), flags.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  for (auto _ : state) {
    const pid_t pid = fork();
    if (pid == 0) {
      const int null = open("/dev/null", O_WRONLY);
      dup2(null, STDOUT_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    int status = 0;
    waitpid(pid, &status, 0);
    if (status != 0) state.SkipWithError("trilobe fit failed");
  }
  const auto report = nlohmann::json::parse(ReadFile(folder / "report.json"));
  state.counters["peak_MB"] = report.at("peak_memory_bytes").get<double>() / 1e6;
  state.counters["E"] = report.at("objective");
  std::filesystem::remove_all(folder);
}

using benchmark::internal::Benchmark;
void OnTheClock(Benchmark* benchmark) { benchmark->Unit(benchmark::kMillisecond)->UseRealTime(); }
void ByTheTrace(Benchmark* benchmark) { benchmark->Unit(benchmark::kMillisecond)->UseManualTime(); }

BENCHMARK(BM_ReadAndPrepare)->Arg(1)->Arg(2)->Apply(OnTheClock);
BENCHMARK(BM_Value)->Arg(1)->Arg(2)->Apply(OnTheClock);
BENCHMARK(BM_ValueReference)->Arg(1)->Apply(OnTheClock);
BENCHMARK(BM_NormalEquations)->Arg(1)->Arg(2)->Apply(OnTheClock);
BENCHMARK(BM_NewtonEquations)->Arg(1)->Arg(2)->Apply(OnTheClock);
BENCHMARK(BM_NormalEquationsReference)->Arg(1)->Apply(OnTheClock)->Iterations(1);
BENCHMARK(BM_AwlsSweep)->Arg(1)->Arg(2)->Apply(ByTheTrace);
BENCHMARK(BM_AwlsReferenceSweep)->Arg(1)->Apply(ByTheTrace)->Iterations(1);
BENCHMARK(BM_ScatteredNormalEquations)->Arg(1)->Arg(2)->Apply(OnTheClock);
BENCHMARK(BM_ScatteredNormalEquationsReference)->Arg(1)->Apply(OnTheClock)->Iterations(1);
BENCHMARK(BM_ScatteredSweep)->Arg(1)->Apply(ByTheTrace);
BENCHMARK(BM_ScatteredSweepReference)->Arg(1)->Apply(ByTheTrace)->Iterations(1);
BENCHMARK(BM_LmIteration)->Arg(1)->Arg(2)->Apply(ByTheTrace);
BENCHMARK(BM_LmPlainIteration)->Arg(2)->Apply(ByTheTrace)->Iterations(1);
BENCHMARK_CAPTURE(BM_Fit, default, {})->Arg(1)->Arg(2)->Apply(OnTheClock)->Iterations(1);
BENCHMARK_CAPTURE(BM_Fit, awls, {"--solver=awls"})
    ->Arg(1)
    ->Arg(2)
    ->Apply(OnTheClock)
    ->Iterations(1);
BENCHMARK_CAPTURE(BM_Fit, lm, {"--solver=lm", "--max_iterations=20"})
    ->Arg(2)
    ->Apply(OnTheClock)
    ->Iterations(1);
BENCHMARK_CAPTURE(BM_Fit, lm_plain, {"--solver=lm_plain", "--max_iterations=1"})
    ->Arg(2)
    ->Apply(OnTheClock)
    ->Iterations(1);

}  // namespace
}  // namespace trilobe

BENCHMARK_MAIN();
