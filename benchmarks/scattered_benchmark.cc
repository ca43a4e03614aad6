// What a scattered sample costs, against the same sample on a grid, and what an anisotropic model
// costs, in processor time of one thread.
//
//   build/release/benchmarks/scattered_benchmark
//
// Both kinds of samples are all bins of one MERL material, synth:plastic with 2 % noise or the file
// that the environment variable TRILOBE_BENCHMARK_SOURCE names, and take turns.

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "model/objective/batch_evaluator.h"
#include "solvers/sums/scattered_equations.h"
#include "solvers/sweep.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/objective/folded_samples.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {
namespace {

const BrdfSamples& OnGrid() {
  static const BrdfSamples samples = [] {
    const char* const source = std::getenv("TRILOBE_BENCHMARK_SOURCE");
    return ValidSamples(LoadTable(source != nullptr ? source : "synth:plastic", {.noise = 0.02}));
  }();
  return samples;
}

Objective MakeObjective(bool scattered) {
  BrdfSamples samples = OnGrid();
  if (scattered) {
    for (const int bin : samples.bins) samples.angles.push_back(samples.grid.Center(bin));
    samples.bins.clear();
  }
  return {std::move(samples), ModelSpec::SharedFactors(3), FindWeighting("compressive")};
}

double ProcessorSeconds(const std::function<void()>& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// `make` prepares the work on an objective, from a start.
using Work = std::function<void()>;
void Compare(benchmark::State& state,
             const std::function<Work(const Objective&, const FactorModel&)>& make) {
  static const Objective grid = MakeObjective(false), scattered = MakeObjective(true);
  static const FactorModel model = FindInitialModel("analytic").make(grid, 1);
  const Work on_grid = make(grid, model), on_scattered = make(scattered, model);
  on_grid();
  on_scattered();
  std::vector<double> grid_seconds, scattered_seconds;
  for (auto _ : state) {
    grid_seconds.push_back(ProcessorSeconds(on_grid));
    scattered_seconds.push_back(ProcessorSeconds(on_scattered));
  }
  const double ns = 1e9 / grid.samples().size();  // the fastest: others were disturbed
  state.counters["grid_ns"] = ns * std::ranges::min(grid_seconds);
  state.counters["scattered_ns"] = ns * std::ranges::min(scattered_seconds);
  state.counters["ratio"] = std::ranges::min(scattered_seconds) / std::ranges::min(grid_seconds);
}

void BM_Value(benchmark::State& state) {
  Compare(state, [](const Objective& objective, const FactorModel& model) -> Work {
    return [&] { benchmark::DoNotOptimize(objective.Value(model)); };
  });
}

void Equations(benchmark::State& state, Hessian hessian) {
  Compare(state, [hessian](const Objective& objective, const FactorModel& model) -> Work {
    auto equations = std::make_shared<NormalEquations>(objective);
    auto result = std::make_shared<QuadraticModel>();
    return [=, &model] { equations->Evaluate(model, hessian, result.get()); };
  });
}
void BM_Equations(benchmark::State& state) { Equations(state, Hessian::kGaussNewton); }
void BM_NewtonEquations(benchmark::State& state) { Equations(state, Hessian::kNewton); }

void BM_Sweep(benchmark::State& state) {
  Compare(state, [](const Objective& objective, const FactorModel& model) -> Work {
    static PhaseSeconds phases;
    std::shared_ptr<Sweep> sweep = MakeSweep(objective, &phases);
    return [&model, sweep] {
      FactorModel moved = model;
      (*sweep)(nullptr, &moved);
    };
  });
}

// 288 x 288 pairs of directions, 15 by 7.5 degrees apart, as an anisotropic model reads them: D
// bilinearly over h, F linearly over theta_d, G at its nodes. 2,010 parameters for three lobes.
constexpr int kThetas = 6, kPhis = 48, kDirections = kThetas * kPhis;

ModelSpec AnisotropicSpec() { return ModelSpec::Anisotropic(3); }

Direction Node(int k) {
  const int a = k / kPhis, b = k % kPhis;
  const double theta = a * kPi / 12, phi = b * kPi / 24;
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

Stencil Bilinear(double theta, double phi) {
  const double a = std::min(theta * 12 / kPi, kThetas - 1.0);
  const double b = (phi < 0 ? phi + 2 * kPi : phi) * 24 / kPi;
  const int a0 = std::min(static_cast<int>(a), kThetas - 2), b0 = static_cast<int>(b) % kPhis;
  const int b1 = (b0 + 1) % kPhis;
  const double s = a - a0, t = b - std::floor(b);
  return {4,
          {a0 * kPhis + b0, a0 * kPhis + b1, (a0 + 1) * kPhis + b0, (a0 + 1) * kPhis + b1},
          {(1 - s) * (1 - t), (1 - s) * t, s * (1 - t), s * t}};
}

const FoldedSamples& AnisotropicSamples() {
  static const FoldedSamples folded = [] {
    std::vector<WeightedSample> samples;
    for (int i = 0; i < kDirections; ++i) {
      for (int o = 0; o < kDirections; ++o) {
        const Direction wi = Node(i), wo = Node(o);
        Direction h;
        for (int k = 0; k < 3; ++k) h[k] = (wi[k] + wo[k]) / 2;
        const double length = std::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
        const double theta_h = std::acos(std::min(1.0, h[2] / length));
        const double theta_d = std::acos(std::min(1.0, length));
        WeightedSample& sample = samples.emplace_back();
        sample.stencils.D = Bilinear(theta_h, std::atan2(h[1], h[0]));
        sample.stencils.F = LinearStencil(theta_d * 180 / kPi, 90);
        sample.stencils.G_i = PointStencil(i);
        sample.stencils.G_o = PointStencil(o);
        sample.stencils.inverse_cosines = 1 / (wi[2] * wo[2]);
        sample.weight = {1, 1, 1};
        for (int c = 0; c < kChannels; ++c) {
          sample.rho[c] = 0.1 * (1 + c) + std::exp(-20 * theta_h * theta_h) * (2 + std::sin(i + c));
        }
      }
    }
    return Fold(samples);
  }();
  return folded;
}

FactorModel AnisotropicModel() {
  FactorModel model(AnisotropicSpec());
  for (size_t k = 0; k < model.parameters().size(); ++k) {
    model.parameters()[k] = 0.5 + 0.1 * std::sin(static_cast<double>(k));
  }
  return model;
}

void BM_AnisotropicValue(benchmark::State& state) {
  const FactorModel model = AnisotropicModel();
  const int threads = static_cast<int>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(FoldedValue(AnisotropicSamples(), model, threads));
  state.counters["folded"] = AnisotropicSamples().size();
}

void BM_AnisotropicEquations(benchmark::State& state) {
  const FactorModel model = AnisotropicModel();
  ScatteredEquations equations(AnisotropicSamples(), model.spec(),
                               static_cast<int>(state.range(0)));
  QuadraticModel result;
  for (auto _ : state) equations.Evaluate(model, Hessian::kGaussNewton, &result);
}

void BM_AnisotropicSweep(benchmark::State& state) {
  PhaseSeconds phases;
  FactorModel model = AnisotropicModel();
  // They live as long as the program.
  const std::shared_ptr<const FoldedSamples> samples(std::shared_ptr<void>(),
                                                     &AnisotropicSamples());
  SampleSweep sweep(samples, model.spec(), static_cast<int>(state.range(0)), &phases);
  for (auto _ : state) sweep(nullptr, &model);
}

BENCHMARK(BM_Value)->Unit(benchmark::kMillisecond)->Iterations(20);
BENCHMARK(BM_Equations)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(BM_NewtonEquations)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(BM_Sweep)->Unit(benchmark::kMillisecond)->Iterations(5);
BENCHMARK(BM_AnisotropicValue)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK(BM_AnisotropicEquations)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK(BM_AnisotropicSweep)
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace trilobe

BENCHMARK_MAIN();
