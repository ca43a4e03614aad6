#ifndef TRILOBE_TESTS_TEST_UTIL_H_
#define TRILOBE_TESTS_TEST_UTIL_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <initializer_list>
#include <numeric>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/weighting.h"

namespace trilobe {

// Whether a sanitizer makes this about ten times slower: tests do less of the same.
#if defined(__has_feature)  // clang
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define TRILOBE_SANITIZED 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TRILOBE_SANITIZED 1
#endif
#if defined(TRILOBE_SANITIZED)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

// Whether a test looks at a combination of choices, given by their numbers: it does at one in `n`,
// and any two choices still meet where there are n or more to choose from for a third. At all with
// TRILOBE_ALL_CHOICES in the environment (scripts/nightly.sh).
inline bool IsOneIn(int n, std::initializer_list<std::ptrdiff_t> choices) {
  static const bool all = std::getenv("TRILOBE_ALL_CHOICES") != nullptr;
  return all || std::accumulate(choices.begin(), choices.end(), std::ptrdiff_t{0}) % n == 0;
}
template <typename T>
std::ptrdiff_t NumberOf(const T& choice, const std::vector<T>& choices) {
  return &choice - choices.data();
}

// Random numbers that are the same on every machine, as <random>'s distributions are not.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }  // [0, 1)
  double Uniform(double lo, double hi) { return lo + (hi - lo) * Uniform(); }
  double Normal() {  // Box and Muller 1958
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    return radius * std::cos(2 * kPi * Uniform());
  }
  double LogNormal(double sigma) { return std::exp(sigma * Normal()); }

 private:
  std::mt19937_64 engine_;
};

struct NamedSpec {
  std::string name;
  ModelSpec spec;
};

// The paper's specs with 0..5 lobes, the one-lobe model with nothing shared, and sharings that
// nobody has published.
inline std::vector<NamedSpec> TestSpecs(const MerlGrid& grid) {
  std::vector<NamedSpec> specs;
  for (int lobes = 0; lobes <= 5; ++lobes) {
    specs.push_back({std::to_string(lobes) + " lobes", ModelSpec::SharedFactors(lobes, grid)});
  }
  specs.push_back({"independent G", ModelSpec::IndependentG(grid)});
  const auto add = [&](const std::string& name, int lobes, TableSharing D, TableSharing F,
                       TableSharing G) {
    ModelSpec spec = ModelSpec::SharedFactors(lobes, grid);
    spec.D = D;
    spec.F = F;
    spec.G = G;
    specs.push_back({name, spec});
  };
  constexpr TableSharing kAll{.per_lobe = false, .per_channel = false};
  constexpr TableSharing kLobe{.per_lobe = true, .per_channel = false};
  constexpr TableSharing kChannel{.per_lobe = false, .per_channel = true};
  constexpr TableSharing kEach{.per_lobe = true, .per_channel = true};
  add("G shared by the lobes", 2, kLobe, kChannel, kAll);
  add("G a channel, shared by the lobes", 3, kLobe, kLobe, kChannel);
  add("F a lobe", 2, kLobe, kLobe, kLobe);
  add("D shared by all", 2, kAll, kChannel, kLobe);
  add("everything shared by all", 2, kAll, kAll, kAll);
  add("nothing shared", 2, kEach, kEach, kEach);
  add("stretched highlights", 2, kLobe, kChannel, kLobe);
  specs.back().spec.stretches = Stretch{.along = -0.4, .across = 0.3};
  add("lobes stretched differently", 3, kLobe, kChannel, kLobe);
  constexpr Stretch kAlong{.along = -0.4, .across = 0.3}, kAcross{.along = 0.2, .across = -0.5};
  specs.back().spec.stretches = Stretches({kAlong, kAcross, kAlong});
  return specs;
}

// All numbers log-normal around 1.
inline FactorModel RandomModel(const ModelSpec& spec, uint64_t seed, double sigma = 0.5) {
  Random random(seed);
  FactorModel model(spec);
  for (double& x : model.parameters()) x = random.LogNormal(sigma);
  return model;
}

// Log-normal values around 1/sr in the bins above the surface, each of which is lost (invalid) with
// a probability: so whole mirror pairs, halves of pairs, and now and then rows are missing.
inline BrdfTable RandomTable(const MerlGrid& grid, uint64_t seed, double lost = 0.2,
                             double sigma = 1) {
  Random random(seed);
  BrdfTable table = MakeInvalidTable("random", grid);
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); ++bin) {
    const bool is_lost = random.Uniform() < lost;
    for (int c = 0; c < kChannels; ++c) {
      const double rho = random.LogNormal(sigma);
      if (above[bin] && !is_lost) table.SetValue(c, bin, rho);
    }
  }
  return table;
}

// Makes all bins of a theta_h invalid, by one channel, so that no data touch D there.
inline void InvalidateThetaH(int theta_h, int channel, BrdfTable* table) {
  const MerlGrid& grid = table->grid;
  for (int d = 0; d < grid.theta_d; ++d) {
    for (int p = 0; p < grid.phi_d; ++p) table->stored[channel][grid.Index(theta_h, d, p)] = -1;
  }
}

// A measurement without error of a material that is of the model's own form.
inline BrdfTable TableOf(const FactorModel& model, const MerlGrid& grid) {
  BrdfTable table = MakeInvalidTable("model", grid);
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (!above[bin]) continue;
    const SampleStencils stencils = GridStencils(model.spec(), grid, bin);
    for (int c = 0; c < kChannels; ++c) table.SetValue(c, bin, UnclampedValue(model, stencils, c));
  }
  return table;
}

// The same directions as samples that are on no grid.
inline BrdfSamples Scattered(BrdfSamples samples) {
  for (const int bin : samples.bins) samples.angles.push_back(samples.grid.Center(bin));
  samples.bins.clear();
  return samples;
}

inline Objective MakeObjective(const BrdfTable& table, const ModelSpec& spec,
                               std::string_view weighting = "compressive", int num_threads = 1) {
  return {ValidSamples(table), spec, FindWeighting(weighting), num_threads};
}

// One reading of a table, and the model's value, in extended precision.
inline long double ExactRead(const Stencil& stencil, std::span<const double> table) {
  long double sum = 0;
  for (int k = 0; k < stencil.size; ++k) {
    sum += static_cast<long double>(stencil.weight[k]) * table[stencil.index[k]];
  }
  return sum;
}

inline long double ExactEvaluate(const FactorModel& model, const SampleStencils& at, int c) {
  long double rho = model.d()[c];
  for (int m = 0; m < model.spec().lobes; ++m) {
    const Stencil& D = at.DOf(model.spec().stretches.index(m));
    rho += model.s(m)[c] * ExactRead(D, model.D(m, c)) * ExactRead(at.F, model.F(m, c)) *
           ExactRead(at.G_i, model.G(m, c)) * ExactRead(at.G_o, model.G(m, c)) * at.inverse_cosines;
  }
  return rho;
}

// E by its definition, sample by sample, in extended precision.
inline long double ExactObjective(const Objective& objective, const FactorModel& model) {
  long double sum = 0;
  for (const WeightedSample& sample : objective.weighted_samples()) {
    for (int c = 0; c < kChannels; ++c) {
      const long double residual = sample.rho[c] - ExactEvaluate(model, sample.stencils, c);
      sum += sample.weight[c] * residual * residual;
    }
  }
  return sum;
}

}  // namespace trilobe

#endif  // TRILOBE_TESTS_TEST_UTIL_H_
