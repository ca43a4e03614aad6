#include "solvers/joint/reflectance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "objective/sample_derivatives.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/nonnegative_step.h"
#include "solvers/joint/reduction.h"
#include "trilobe/base/stop_check.h"
#include "trilobe/brdf/brdf_samples.h"
#include "trilobe/objective/quadratic_model.h"
#include "trilobe/sums/normal_equations.h"
#include "trilobe/system/parallel.h"

namespace trilobe {
namespace {

constexpr int kTrials = 8;
constexpr double kFirstLambda = 1e-3, kFall = 1.0 / 3, kRise = 4;
constexpr double kHardlyLower = 2e-3;

// The reflectance, and how it moves with the parameters.
struct Light {
  Reflectance reflectance;
  std::array<std::vector<double>, kChannels> slope;  // of what is fitted. [num_parameters]
};

enum class Slopes { kNone, kAll };

// Every few samples are enough: what is measured and what is fitted are summed over the same ones.
// A stride that has no factor in common with the number of bins of phi_d visits all of these.
int StrideOf(const BrdfSamples& samples) {
  constexpr int kSamplesLookedAt = 1 << 16;
  int stride = std::max(1, samples.size() / kSamplesLookedAt);
  while (std::gcd(stride, samples.grid.phi_d) > 1) ++stride;
  return stride;
}

Light LightOf(const Objective& objective, const FactorModel& model, Slopes slopes) {
  constexpr int kParts = 16;
  const BrdfSamples& samples = objective.samples();
  const int stride = StrideOf(samples);
  const int num_parameters = slopes == Slopes::kAll ? model.spec().num_parameters() : 0;
  struct Part {
    double through = 0;
    Light light;
  };
  std::vector<Part> parts(kParts);
  const int size = (samples.size() + stride - 1) / stride;
  ParallelFor(kParts, objective.num_threads(), [&](int k) {
    Part part;
    for (auto& slope : part.light.slope) slope.assign(num_parameters, 0.0);
    SampleDerivatives derivatives(num_parameters);
    const auto begin = static_cast<int>(static_cast<int64_t>(size) * k / kParts);
    const auto end = static_cast<int>(static_cast<int64_t>(size) * (k + 1) / kParts);
    for (int j = begin * stride; j < end * stride; j += stride) {
      const Cosines cosines = samples.CosinesOf(j);
      const double through = samples.SolidAngle(j) * cosines.i * cosines.o;
      const SampleStencils at = objective.Sample(j).stencils;
      part.through += through;
      for (int c = 0; c < kChannels; ++c) {
        part.light.reflectance.measured[c] += through * samples.rho[j][c];
        part.light.reflectance.fitted[c] += through * UnclampedValue(model, at, c);
        if (slopes == Slopes::kNone) continue;
        derivatives.Set(model, at, c);
        for (const int x : derivatives.touched()) {
          part.light.slope[c][x] += through * derivatives[x];
        }
      }
    }
    parts[k] = std::move(part);
  });
  Light light = std::move(parts[0].light);
  double through = parts[0].through;
  for (int k = 1; k < kParts; ++k) {
    const Light& part = parts[k].light;
    through += parts[k].through;
    for (int c = 0; c < kChannels; ++c) {
      light.reflectance.measured[c] += part.reflectance.measured[c];
      light.reflectance.fitted[c] += part.reflectance.fitted[c];
      for (int x = 0; x < num_parameters; ++x) light.slope[c][x] += part.slope[c][x];
    }
  }
  for (int c = 0; c < kChannels; ++c) {
    light.reflectance.measured[c] /= through;
    light.reflectance.fitted[c] /= through;
    for (double& x : light.slope[c]) x /= through;
  }
  return light;
}

// Adds price |fitted - target|^2 / |target|^2 to a problem in parameters of which `slope_of` makes
// slopes, of those in all.
template <typename SlopeOf>
void AddPrice(double price, const Rgb& target, const Light& light, const SlopeOf& slope_of,
              QuadraticModel* at) {
  const double of_squares = price / std::pow(std::hypot(target[0], target[1], target[2]), 2);
  const size_t n = at->gradient.size();
  for (int c = 0; c < kChannels; ++c) {
    const std::vector<double>& slope = slope_of(light.slope[c]);
    const double off = light.reflectance.fitted[c] - target[c];
    for (size_t a = 0; a < n; ++a) {
      if (slope[a] == 0) continue;
      at->gradient[a] += of_squares * off * slope[a];
      for (size_t b = 0; b < n; ++b) at->H[a * n + b] += of_squares * slope[a] * slope[b];
    }
  }
}

}  // namespace

double Reflectance::Error() const { return RelativeDistance(fitted, measured); }

Reflectance ReflectanceOf(const Objective& objective, const FactorModel& model) {
  CheckSameSpec(model.spec(), objective.spec());
  return LightOf(objective, model, Slopes::kNone).reflectance;
}

ReflectancePrice::ReflectancePrice(const Objective& objective, const FactorModel& model,
                                   double price)
    : objective_(objective), target_(ReflectanceOf(objective, model).fitted), price_(price) {}

double ReflectancePrice::operator()(const FactorModel& model) const {
  return price_ * std::pow(RelativeDistance(ReflectanceOf(objective_, model).fitted, target_), 2);
}

void ReflectancePrice::AddTo(const FactorModel& model, QuadraticModel* at) const {
  if (target_ == Rgb{}) return;
  const Light light = LightOf(objective_, model, Slopes::kAll);
  at->objective += price_ * std::pow(RelativeDistance(light.reflectance.fitted, target_), 2);
  AddPrice(price_, target_, light, std::identity(), at);
}

std::optional<MatchedModel> MatchReflectance(const Objective& objective, const Objective& minimised,
                                             const FactorModel& model, const TableLayout& layout,
                                             double price, const StopCheck& stop) {
  CheckSameSpec(model.spec(), objective.spec());
  CheckSameSpec(model.spec(), minimised.spec());
  CheckParameters(model);
  CheckLayout(layout, objective.spec());
  const Reflectance reflectance = ReflectanceOf(objective, model);
  if (!reflectance.IsOff()) return std::nullopt;
  const double before = reflectance.Error();
  const Reduction reduction(objective.spec(), layout);
  const double E0 = objective.Value(model);
  const auto total = [&](double E, double error) { return E + price * E0 * std::pow(error, 2); };
  MatchedModel at{.model = model, .error_before = before, .error_after = before};
  double lowest = total(minimised.Value(model), before), lambda = kFirstLambda;
  NormalEquations equations(minimised);
  NonnegativeStep step(objective.num_threads());
  QuadraticModel problem;
  bool moved = false, linearized = false;
  for (int trial = 0; trial < kTrials && !stop(); ++trial) {
    if (!linearized) {
      equations.Evaluate(at.model, Hessian::kGaussNewton, &problem);
      problem = reduction(problem);
      const std::vector<double> metric = DampingMetric(reduction.parts(), problem.squared_lengths);
      const Light light = LightOf(objective, at.model, Slopes::kAll);
      AddPrice(
          price * E0, light.reflectance.measured, light,
          [&](const std::vector<double>& slope) { return reduction.Transpose(slope); }, &problem);
      step.MoveTo(problem, metric, reduction.Restrict(at.model.parameters()));
      linearized = true;
    }
    FactorModel stepped = at.model;
    std::ranges::copy(reduction.Expand(step.Solve(lambda).x), stepped.parameters().begin());
    const double error = ReflectanceOf(objective, stepped).Error();
    const double lower = total(minimised.Value(stepped), error);
    if (!(lower < lowest)) {
      lambda *= kRise;
      continue;
    }
    const bool small = lower > (1 - kHardlyLower) * lowest;
    at.model = std::move(stepped);
    at.error_after = error;
    lowest = lower;
    lambda *= kFall;
    moved = true;
    linearized = false;
    if (small) break;
  }
  if (!moved) return std::nullopt;
  return at;
}

}  // namespace trilobe
