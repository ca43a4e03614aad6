#include "experiments/stiff/cases.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "core/base/names.h"
#include "experiments/stiff/anisotropic_cases.h"
#include "experiments/stiff/material.h"
#include "tests/test_util.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe {
namespace {

constexpr MerlGrid kGrid{.theta_h = 6, .theta_d = 6, .phi_d = 8};
constexpr MerlGrid kFineGrid{.theta_h = 6, .theta_d = 6, .phi_d = 96};  // for losses of bins

// --- Materials: models with tables that are smooth but for a jitter, so that nothing is special
// ---

void SetTable(Factor factor, int index, double jitter, Random* random, FactorModel* model,
              double (*curve)(double angle, double parameter), double parameter) {
  const std::span<double> table = model->table(factor, index);
  const MerlGrid grid{.theta_h = static_cast<int>(table.size())};
  for (int k = 0; k < grid.theta_h; ++k) {
    const double angle = factor == Factor::kD
                             ? grid.ThetaH(k + 0.5)
                             : (k + 0.5) / static_cast<int>(table.size()) * kPi / 2;
    table[k] = curve(angle, parameter) * random->LogNormal(jitter);
  }
}

double Ggx(double theta_h, double alpha) {
  const double cosine = std::cos(theta_h), sine = std::sin(theta_h);
  const double t = sine * sine + alpha * alpha * cosine * cosine;
  return alpha * alpha / (kPi * t * t);
}

// Lobes from narrow to wide, each with its own colour.
FactorModel Material(int lobes, const MerlGrid& grid = kGrid) {
  constexpr double kAlpha[] = {0.12, 0.3, 0.7}, kShadowing[] = {0.5, 1.5, 4};
  Random random(1);
  FactorModel model(ModelSpec::SharedFactors(lobes, grid));
  std::ranges::copy(kDiffuse, model.d().begin());
  for (int m = 0; m < lobes; ++m) {
    std::ranges::copy(kWeight[m], model.s(m).begin());
    SetTable(Factor::kD, m, kJitter, &random, &model, Ggx, kAlpha[m]);
    SetTable(Factor::kG, m, kJitter, &random, &model, Shadowing, kShadowing[m]);
  }
  for (int c = 0; c < kChannels; ++c) {
    SetTable(Factor::kF, c, kJitter, &random, &model, Schlick, kF0[c]);
  }
  return model;
}

// --- Measurements -------------------------------------------------------------------------------

// The values of a model, rounded once, in all bins above the surface.
StiffProblem Measure(const FactorModel& truth, const MerlGrid& grid = kGrid) {
  StiffProblem problem;
  problem.samples = {"stiff", grid, {}, {}, {}};
  problem.spec = truth.spec();
  problem.truth = truth;
  const std::vector<bool> above = BinsAboveSurface(grid);
  for (int bin = 0; bin < grid.size(); ++bin) {
    if (!above[bin]) continue;
    const SampleStencils at = GridStencils(truth.spec(), grid, bin);
    Rgb rho;
    for (int c = 0; c < kChannels; ++c) {
      rho[c] = std::max(0.0, static_cast<double>(ExactEvaluate(truth, at, c)));
    }
    problem.samples.bins.push_back(bin);
    problem.samples.rho.push_back(rho);
  }
  return problem;
}

StiffProblem Weighted(StiffProblem problem, const std::string& weighting) {
  problem.weighting = weighting;
  return problem;
}

template <typename Predicate>  // bool(int bin)
StiffProblem Kept(StiffProblem problem, Predicate keep) {
  BrdfSamples kept{problem.samples.source, problem.samples.grid, {}, {}, {}};
  for (int j = 0; j < problem.samples.size(); ++j) {
    if (!keep(problem.samples.bins[j])) continue;
    kept.bins.push_back(problem.samples.bins[j]);
    kept.rho.push_back(problem.samples.rho[j]);
  }
  problem.samples = kept;
  return problem;
}

StiffProblem LostAtRandom(double share) {
  Random random(3);
  return Kept(Noisy(Measure(Material(2, kFineGrid), kFineGrid), 0.02),
              [&](int) { return random.Uniform() >= share; });
}

// This share of the boxes of 2 x 2 x 12 bins is lost.
StiffProblem LostInBlocks(double share) {
  Random random(4);
  std::vector<double> of_block(3 * 3 * 8);
  for (double& u : of_block) u = random.Uniform();
  std::vector<double> sorted = of_block;
  std::ranges::sort(sorted);
  const double least = sorted[static_cast<size_t>(share * static_cast<double>(sorted.size()))];
  return Kept(Noisy(Measure(Material(2, kFineGrid), kFineGrid), 0.02), [&](int bin) {
    const int h = bin / (6 * 96), d = bin / 96 % 6, p = bin % 96;
    return of_block[(h / 2 * 3 + d / 2) * 8 + p / 12] >= least;
  });
}

// D falls by so many powers of ten from the first bin to the last; nothing else shines there.
FactorModel SteepMaterial(double decades) {
  FactorModel model = Material(1);
  std::ranges::fill(model.d(), 0.0);
  const std::span<double> D = model.table(Factor::kD, 0);
  Random random(5);
  for (size_t k = 0; k < D.size(); ++k) {
    D[k] = 10 * std::pow(10.0, -decades * static_cast<double>(k) / 5) * random.LogNormal(0.1);
  }
  return model;
}

double Cosine(std::span<const double> a, std::span<const double> b) {
  double ab = 0, aa = 0, bb = 0;
  for (size_t k = 0; k < a.size(); ++k) {
    ab += a[k] * b[k];
    aa += a[k] * a[k];
    bb += b[k] * b[k];
  }
  return ab / std::sqrt(aa * bb);
}

// Two lobes whose D and G have cosines of this product; their colours differ.
FactorModel CongruentLobes(double congruence) {
  FactorModel model = Material(2);
  std::ranges::copy(Rgb{0.3, 0.4, 0.6}, model.s(0).begin());
  std::ranges::copy(Rgb{0.6, 0.4, 0.2}, model.s(1).begin());
  // The second lobe is the first, its entries alternately up and down; bisection for how much.
  double low = 0, high = 1;
  for (int step = 0; step < 60; ++step) {
    const double amount = (low + high) / 2;
    double product = 1;
    for (const Factor factor : {Factor::kD, Factor::kG}) {
      const std::span<double> first = model.table(factor, 0), second = model.table(factor, 1);
      for (size_t k = 0; k < first.size(); ++k) {
        const double sign = (k + (factor == Factor::kG)) / 2 % 2 == 0 ? 1 : -1;
        second[k] = first[k] * std::exp(sign * amount);
      }
      product *= Cosine(first, second);
    }
    (product > congruence ? low : high) = amount;
  }
  return model;
}

// The library's start with one kind of number wrong by a factor.
StiffProblem WrongStart(double D, double F, double G, double s) {
  StiffProblem problem = Measure(Material(2));
  FactorModel start = StartOf(problem, MakeObjective(problem));
  const double wrong[] = {D, F, G};
  for (const Factor factor : kFactors) {
    for (int t = 0; t < start.spec().num_tables(factor); ++t) {
      for (double& x : start.table(factor, t)) x *= wrong[static_cast<int>(factor)];
    }
  }
  for (int m = 0; m < start.spec().lobes; ++m) {
    for (double& x : start.s(m)) x *= s;
  }
  problem.start = start;
  return problem;
}

// --- The cases ----------------------------------------------------------------------------------

StiffProblem Regular() { return Measure(Material(2)); }
StiffProblem RegularThree() { return Noisy(Measure(Material(3)), 0.02); }

StiffProblem MirrorDelta() {
  FactorModel model = Material(2);
  const std::span<double> D = model.table(Factor::kD, 0);
  std::ranges::fill(D, 0.0);
  D[0] = 1e4;
  return Measure(model);
}

StiffProblem MirrorTail() {
  FactorModel model = Material(1);
  Random random(6);
  SetTable(Factor::kD, 0, 0.1, &random, &model, Ggx, 1e-3);
  return Measure(model);
}

StiffProblem Lambertian() {
  FactorModel model = Material(3);
  for (int m = 0; m < 3; ++m) std::ranges::fill(model.s(m), 0.0);
  return Measure(model);
}

StiffProblem Black() { return Measure(FactorModel(ModelSpec::SharedFactors(3, kGrid))); }

StiffProblem ChannelZero() {
  FactorModel model = Material(3);
  model.d()[1] = 0;
  for (int m = 0; m < 3; ++m) model.s(m)[1] = 0;
  return Measure(model);
}

StiffProblem WeakLobes() {
  FactorModel model = Material(3);
  for (double& x : model.s(1)) x *= 1e-4;
  for (double& x : model.s(2)) x *= 1e-8;
  return Measure(model);
}

StiffProblem IdenticalStart() {
  StiffProblem problem = Measure(Material(3));
  FactorModel start = StartOf(problem, MakeObjective(problem));
  for (int m = 1; m < 3; ++m) {
    std::ranges::copy(start.s(0), start.s(m).begin());
    for (const Factor factor : {Factor::kD, Factor::kG}) {
      std::ranges::copy(start.table(factor, 0), start.table(factor, m).begin());
    }
  }
  problem.start = start;
  return problem;
}

StiffProblem GrazingOnly() {
  return Kept(Regular(), [](int bin) {
    const Cosines cosines = ToCosines(kGrid.Center(bin));
    return std::min(cosines.i, cosines.o) < std::cos(DegreesToRadians(75));
  });
}

StiffProblem NormalOnly() {
  return Kept(Regular(), [](int bin) {
    const Cosines cosines = ToCosines(kGrid.Center(bin));
    return std::max(cosines.i, cosines.o) > std::cos(DegreesToRadians(15));
  });
}

StiffProblem HotPixels() {
  StiffProblem problem = Noisy(Regular(), 0.02);
  for (int k = 0; k < 5; ++k) {
    problem.samples.rho[problem.samples.size() * (2 * k + 1) / 10][k % kChannels] = 1e6;
  }
  return problem;
}

// Student's t with 2 degrees of freedom, no variance, in the exponent's place of 10 % noise.
StiffProblem HeavyTails() {
  Random random(7);
  return Changed(Regular(), [&](double rho) {
    const double a = random.Normal(), b = random.Normal(), z = random.Normal();
    return rho * std::max(0.0, 1 + 0.1 * z / std::sqrt((a * a + b * b) / 2));
  });
}

StiffProblem Quantised() {
  return Changed(Regular(), [](double rho) { return std::round(rho * 16) / 16; });
}

StiffProblem InUnits(double unit) {
  return Weighted(Changed(Noisy(Regular(), 0.02), [=](double rho) { return rho * unit; }),
                  "uniform");
}

StiffProblem WeightDecades() {
  FactorModel model = SteepMaterial(10);
  for (double& x : model.s(0)) x *= 1e3;
  return Weighted(Noisy(Measure(model), 0.02), "percentage");
}

StiffProblem DenormalTail() {
  FactorModel model = SteepMaterial(4);
  const std::span<double> D = model.table(Factor::kD, 0);
  D[4] = 3e-310;
  D[5] = 2e-312;
  return Measure(model);
}

StiffProblem FloatStorage() {
  return Changed(Regular(), [](double rho) {
    // Without volatile, gcc 12 leaves some values in double precision.
    volatile auto single = static_cast<float>(rho);
    return static_cast<double>(single);
  });
}

std::vector<StiffCase> IsotropicCases() {
  return {
      {"regular", "two lobes without error: nothing is hard", Regular},
      {"regular_three", "three lobes, 2 % noise: nothing is hard", RegularThree},
      {"mirror_delta", "a lobe that fills one bin of D, the others 0", MirrorDelta},
      {"mirror_tail", "a highlight 0.06 degrees wide, narrower than the first bin of 2.5 degrees",
       MirrorTail},
      {"range_1e8", "D falls by 1e8", [] { return Measure(SteepMaterial(8)); }},
      {"range_1e8_uniform", "D falls by 1e8, all weights 1",
       [] { return Weighted(Measure(SteepMaterial(8)), "uniform"); }},
      {"range_1e12", "D falls by 1e12", [] { return Measure(SteepMaterial(12)); }},
      {"range_1e12_uniform", "D falls by 1e12, all weights 1",
       [] { return Weighted(Measure(SteepMaterial(12)), "uniform"); }},
      {"lambertian", "purely Lambertian, three lobes: no table is determined", Lambertian},
      {"black", "all values 0", Black},
      {"channel_zero", "three lobes, green is 0", ChannelZero},
      {"weak_lobes", "three lobes of weights 1 : 1e-4 : 1e-8", WeakLobes},
      {"congruent_99", "two lobes of congruence 0.99",
       [] { return Measure(CongruentLobes(0.99)); }},
      {"congruent_9999", "two lobes of congruence 0.9999",
       [] { return Measure(CongruentLobes(0.9999)); }},
      {"identical_start", "three lobes that start identical, on a saddle", IdenticalStart},
      {"grazing_only", "only samples with a direction 75 degrees or more from the normal",
       GrazingOnly},
      {"normal_only", "only samples with a direction 15 degrees or less from the normal",
       NormalOnly},
      {"lost_90_random", "90 % of the bins missing at random, 2 % noise",
       [] { return LostAtRandom(0.9); }},
      {"lost_99_random", "99 % of the bins missing at random, 2 % noise",
       [] { return LostAtRandom(0.99); }},
      {"lost_90_blocks", "90 % of the bins missing in blocks, 2 % noise",
       [] { return LostInBlocks(0.9); }},
      {"lost_99_blocks", "99 % of the bins missing in blocks, 2 % noise",
       [] { return LostInBlocks(0.99); }},
      {"hot_pixels", "five values of 1e6, 2 % noise", HotPixels},
      {"hot_pixels_uniform", "five values of 1e6, 2 % noise, all weights 1",
       [] { return Weighted(HotPixels(), "uniform"); }},
      {"noise_1", "1 % noise", [] { return Noisy(Regular(), 0.01); }},
      {"noise_10", "10 % noise", [] { return Noisy(Regular(), 0.1); }},
      {"noise_50", "50 % noise", [] { return Noisy(Regular(), 0.5); }},
      {"heavy_tails", "noise without variance (Student's t, 2 degrees of freedom, scale 10 %)",
       HeavyTails},
      {"quantised", "values rounded to sixteenths", Quantised},
      {"units_1e-12", "values times 1e-12, 2 % noise, all weights 1",
       [] { return InUnits(1e-12); }},
      {"units_1e12", "values times 1e12, 2 % noise, all weights 1", [] { return InUnits(1e12); }},
      {"start_up", "D, F, G and s start 1e6 times too large: values 1e30 times",
       [] { return WrongStart(1e6, 1e6, 1e6, 1e6); }},
      {"start_down", "D, F, G and s start 1e6 times too small: values 1e30 times",
       [] { return WrongStart(1e-6, 1e-6, 1e-6, 1e-6); }},
      {"start_mixed", "D starts 1e6 times too large and F as much too small: the same values",
       [] { return WrongStart(1e6, 1e-6, 1, 1); }},
      {"weight_decades", "weights 1/(rho + 0.001)^2 over twelve decades, 2 % noise", WeightDecades},
      {"denormal_tail", "the last bins of D below 1e-308", DenormalTail},
      {"float_storage", "two lobes without error, stored in single precision", FloatStorage},
  };
}

}  // namespace

const std::vector<StiffCase>& StiffCases() {
  static const std::vector<StiffCase> cases = [] {
    std::vector<StiffCase> all = IsotropicCases();
    std::ranges::move(AnisotropicCases(), std::back_inserter(all));
    return all;
  }();
  return cases;
}

const StiffCase& FindStiffCase(std::string_view name) {
  return FindNamed("case", name, StiffCases());
}

Objective MakeObjective(const StiffProblem& problem) {
  return {problem.samples, problem.spec, FindWeighting(problem.weighting)};
}

FactorModel StartOf(const StiffProblem& problem, const Objective& objective) {
  if (problem.start) return *problem.start;
  return InitialModels().front().make(objective, /*seed=*/1);
}

}  // namespace trilobe
