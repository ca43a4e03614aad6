// What a renderer pays for a fitted model: a value, a density and a sample of Bsdf, beside those of
// an analytic material with one GGX lobe, and the literal evaluation, in one run.
//
//   build/release/benchmarks/evaluate_benchmark
//
// Pairs of directions are distributed by cosines; the models have three lobes on the paper's
// tables.

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "benchmarks/ggx.h"
#include "experiments/sampling/ndf_sampler.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/bsdf.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {
namespace {

struct Call {
  DirectionPair pair;
  std::array<double, 2> u;
};

const std::vector<Call>& Calls() {
  static const std::vector<Call> calls = [] {
    std::mt19937_64 engine(1);
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto direction = [&] {
      const double r = std::sqrt(uniform(engine)), phi = 2 * kPi * uniform(engine);
      return Direction{r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - r * r)};
    };
    std::vector<Call> some(4096);
    for (Call& call : some) {
      call = {{direction(), direction()}, {uniform(engine), uniform(engine)}};
    }
    return some;
  }();
  return calls;
}

// Tables of a plausible material; only how they are read takes time.
FactorModel Material(const ModelSpec& spec) {
  FactorModel model(spec);
  for (double& x : model.parameters()) x = 1;
  for (int m = 0; m < spec.lobes; ++m) {
    const double alpha = 0.1 * (1 + m);
    for (int e = 0; e < spec.d_axis.size; ++e) {
      const double cos2 = std::pow(std::cos(spec.d_axis.Theta(e)), 2);
      model.table(Factor::kD, m)[e] = std::pow(cos2 * (alpha * alpha - 1) + 1, -2);
    }
  }
  return model;
}

template <typename Function>
void Run(benchmark::State& state, const Function& function) {
  size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(function(Calls()[k++ % Calls().size()]));
  }
  state.SetItemsProcessed(static_cast<int64_t>(state.iterations()));
}

template <typename Material>
void Value(benchmark::State& state, const Material& material) {
  Run(state, [&](const Call& call) { return material.Value(call.pair.wi, call.pair.wo); });
}
// All pairs at once.
template <typename Real>
void Values(benchmark::State& state, const FactorModel& model) {
  const Bsdf<Real> bsdf(model);
  using Vector = typename Bsdf<Real>::Vector;
  const auto rounded = [](const Direction& w) {
    return Vector{static_cast<Real>(w[0]), static_cast<Real>(w[1]), static_cast<Real>(w[2])};
  };
  std::vector<Vector> wi, wo;
  for (const Call& call : Calls()) {
    wi.push_back(rounded(call.pair.wi));
    wo.push_back(rounded(call.pair.wo));
  }
  std::vector<Vector> values(wi.size());
  for (auto _ : state) {
    bsdf.Values(wi, wo, values);
    benchmark::DoNotOptimize(values.data());
  }
  state.SetItemsProcessed(static_cast<int64_t>(state.iterations() * wi.size()));
}
// A sample of all wi, and densities of all pairs.
template <typename Real>
void Samples(benchmark::State& state, const FactorModel& model) {
  const Bsdf<Real> bsdf(model);
  std::vector<typename Bsdf<Real>::Vector> wi;
  std::vector<std::array<Real, 2>> u;
  for (const Call& call : Calls()) {
    wi.push_back({static_cast<Real>(call.pair.wi[0]), static_cast<Real>(call.pair.wi[1]),
                  static_cast<Real>(call.pair.wi[2])});
    u.push_back({static_cast<Real>(call.u[0]), static_cast<Real>(call.u[1])});
  }
  std::vector<typename Bsdf<Real>::Sample> samples(wi.size());
  for (auto _ : state) {
    bsdf.SamplesOfWo(wi, u, samples);
    benchmark::DoNotOptimize(samples.data());
  }
  state.SetItemsProcessed(static_cast<int64_t>(state.iterations() * wi.size()));
}
void Pdfs(benchmark::State& state, const FactorModel& model) {
  const Bsdf<double> bsdf(model);
  std::vector<Direction> wi, wo;
  for (const Call& call : Calls()) {
    wi.push_back(call.pair.wi);
    wo.push_back(call.pair.wo);
  }
  std::vector<double> pdfs(wi.size());
  for (auto _ : state) {
    bsdf.Pdfs(wi, wo, pdfs);
    benchmark::DoNotOptimize(pdfs.data());
  }
  state.SetItemsProcessed(static_cast<int64_t>(state.iterations() * wi.size()));
}
template <typename Material>
void SampleAndPdf(benchmark::State& state, const Material& material) {
  Run(state, [&](const Call& call) {
    const auto sample = material.SampleWo(call.pair.wi, call.u);
    return sample.weight[0] + material.Pdf(call.pair.wi, call.pair.wo);
  });
}

const FactorModel& Isotropic() {
  static const FactorModel model = Material(ModelSpec::SharedFactors(3));
  return model;
}
const FactorModel& Anisotropic() {
  static const FactorModel model = Material(ModelSpec::Anisotropic(3));
  return model;
}

void BM_ValueGgx(benchmark::State& state) { Value(state, Ggx()); }
void BM_ValueIsotropic(benchmark::State& state) { Value(state, Bsdf<double>(Isotropic())); }
void BM_ValueAnisotropic(benchmark::State& state) { Value(state, Bsdf<double>(Anisotropic())); }
void BM_ValueReference(benchmark::State& state) {
  Run(state, [](const Call& call) { return Evaluate(Isotropic(), call.pair); });
}
void BM_ValuesIsotropic(benchmark::State& state) { Values<double>(state, Isotropic()); }
void BM_ValuesAnisotropic(benchmark::State& state) { Values<double>(state, Anisotropic()); }
void BM_ValuesIsotropicFloat(benchmark::State& state) { Values<float>(state, Isotropic()); }
void BM_ValuesAnisotropicFloat(benchmark::State& state) { Values<float>(state, Anisotropic()); }
void BM_SampleAndPdfGgx(benchmark::State& state) { SampleAndPdf(state, Ggx()); }
void BM_SampleAndPdfIsotropic(benchmark::State& state) {
  SampleAndPdf(state, Bsdf<double>(Isotropic()));
}
void BM_SampleAndPdfAnisotropic(benchmark::State& state) {
  SampleAndPdf(state, Bsdf<double>(Anisotropic()));
}
void BM_SamplesIsotropic(benchmark::State& state) { Samples<double>(state, Isotropic()); }
void BM_SamplesIsotropicFloat(benchmark::State& state) { Samples<float>(state, Isotropic()); }
void BM_SamplesAnisotropic(benchmark::State& state) { Samples<double>(state, Anisotropic()); }
void BM_PdfsIsotropic(benchmark::State& state) { Pdfs(state, Isotropic()); }
// How many of 100 directions that are drawn lie below the horizon, at some theta_i.
template <typename Sampler>
void Lost(benchmark::State& state, const Sampler& sampler) {
  const double theta = DegreesToRadians(static_cast<double>(state.range(0)));
  const Direction wi = ToDirection({theta, 0});
  int64_t lost = 0;
  for (auto _ : state) {
    for (const Call& call : Calls()) lost += !(sampler.SampleWo(wi, call.u).pdf > 0);
  }
  const auto drawn = static_cast<double>(state.iterations()) * static_cast<double>(Calls().size());
  state.counters["lost_percent"] = 100 * static_cast<double>(lost) / drawn;
}
void BM_LostByTheNdf(benchmark::State& state) { Lost(state, NdfSampler(Isotropic())); }
void BM_LostByBsdf(benchmark::State& state) { Lost(state, Bsdf<double>(Isotropic())); }
void BM_MakeIsotropic(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Bsdf<double>(Isotropic()).half_vectors().num_s());
}
void BM_MakeAnisotropic(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Bsdf<double>(Anisotropic()).half_vectors().num_s());
}

BENCHMARK(BM_ValueGgx);
BENCHMARK(BM_ValueIsotropic);
BENCHMARK(BM_ValueAnisotropic);
BENCHMARK(BM_ValueReference);
BENCHMARK(BM_ValuesIsotropic);
BENCHMARK(BM_ValuesAnisotropic);
BENCHMARK(BM_ValuesIsotropicFloat);
BENCHMARK(BM_ValuesAnisotropicFloat);
BENCHMARK(BM_SampleAndPdfGgx);
BENCHMARK(BM_SampleAndPdfIsotropic);
BENCHMARK(BM_SampleAndPdfAnisotropic);
BENCHMARK(BM_SamplesIsotropic);
BENCHMARK(BM_SamplesIsotropicFloat);
BENCHMARK(BM_SamplesAnisotropic);
BENCHMARK(BM_PdfsIsotropic);
BENCHMARK(BM_LostByTheNdf)->Arg(0)->Arg(30)->Arg(60)->Arg(75)->Arg(85)->Iterations(1);
BENCHMARK(BM_LostByBsdf)->Arg(0)->Arg(30)->Arg(60)->Arg(75)->Arg(85)->Iterations(1);
BENCHMARK(BM_MakeIsotropic)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_MakeAnisotropic)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace trilobe

BENCHMARK_MAIN();
