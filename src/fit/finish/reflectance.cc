#include "fit/finish/reflectance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "model/objective/sample_derivatives.h"
#include "model/objective/stencils_of.h"
#include "solvers/joint/joint_step.h"
#include "solvers/joint/nonnegative_step.h"
#include "solvers/joint/reduction.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/solvers/sums/normal_equations.h"

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

}  // namespace

// The samples that stand for all, and how they read the tables: what is measured and what is fitted
// are summed over the same ones.
class SampledLight {
 public:
  explicit SampledLight(const Objective& objective)
      : spec_(objective.spec()), num_threads_(objective.num_threads()) {
    constexpr int kSamples = 1 << 16;
    const BrdfSamples samples = objective.EvenlySpread(kSamples);
    size_ = samples.size();
    at_.resize(size_);
    ParallelFor(kParts, num_threads_, [&](int part) {
      for (int j = Begin(part); j < Begin(part + 1); ++j) {
        const Cosines cosines = samples.CosinesOf(j);
        at_[j] = {samples.SolidAngle(j) * cosines.i * cosines.o, StencilsOf(spec_, samples, j)};
      }
    });
    for (int j = 0; j < size_; ++j) {
      through_ += at_[j].through;
      for (int c = 0; c < kChannels; ++c) measured_[c] += at_[j].through * samples.rho[j][c];
    }
    for (double& x : measured_) x /= through_;
  }

  // Light and slopes of a model with the objective's spec. The same bits for any number of threads.
  Light Evaluate(const FactorModel& model, Slopes slopes) const {
    const int num_parameters = slopes == Slopes::kAll ? spec_.num_parameters() : 0;
    std::vector<Light> parts(kParts);
    ParallelFor(kParts, num_threads_, [&](int part) {
      Light light;
      for (auto& slope : light.slope) slope.assign(num_parameters, 0.0);
      for (int j = Begin(part); j < Begin(part + 1); ++j) {
        const auto& [through, stencils] = at_[j];
        for (int c = 0; c < kChannels; ++c) {
          light.reflectance.fitted[c] += through * UnclampedValue(model, stencils, c);
          if (slopes == Slopes::kNone) continue;
          SampleDerivatives::Visit(
              model, stencils, c,
              [&slope = light.slope[c], scale = through](int parameter, double value) {
                slope[parameter] += scale * value;
              });
        }
      }
      parts[part] = std::move(light);
    });
    Light sum = std::move(parts[0]);
    sum.reflectance.measured = measured_;
    for (int c = 0; c < kChannels; ++c) {
      for (int k = 1; k < kParts; ++k) {
        sum.reflectance.fitted[c] += parts[k].reflectance.fitted[c];
        for (int x = 0; x < num_parameters; ++x) sum.slope[c][x] += parts[k].slope[c][x];
      }
      sum.reflectance.fitted[c] /= through_;
      for (double& x : sum.slope[c]) x /= through_;
    }
    return sum;
  }

 private:
  static constexpr int kParts = 16;
  struct At {
    double through = 0;
    SampleStencils stencils;
  };

  int Begin(int part) const { return static_cast<int>(int64_t{size_} * part / kParts); }

  const ModelSpec spec_;
  const int num_threads_;
  int size_ = 0;
  double through_ = 0;
  Rgb measured_{};
  std::vector<At> at_;
};

namespace {

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
  return SampledLight(objective).Evaluate(model, Slopes::kNone).reflectance;
}

ReflectancePrice::ReflectancePrice(const Objective& objective, const FactorModel& model,
                                   double price)
    : light_(std::make_unique<const SampledLight>(objective)), price_(price) {
  CheckSameSpec(model.spec(), objective.spec());
  target_ = light_->Evaluate(model, Slopes::kNone).reflectance.fitted;
}

ReflectancePrice::~ReflectancePrice() = default;

double ReflectancePrice::operator()(const FactorModel& model) const {
  const Reflectance reflectance = light_->Evaluate(model, Slopes::kNone).reflectance;
  return price_ * std::pow(RelativeDistance(reflectance.fitted, target_), 2);
}

void ReflectancePrice::AddTo(const FactorModel& model, QuadraticModel* at) const {
  if (target_ == Rgb{}) return;
  const Light light = light_->Evaluate(model, Slopes::kAll);
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
  const SampledLight sampled(objective);
  const Reflectance reflectance = sampled.Evaluate(model, Slopes::kNone).reflectance;
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
      const Light light = sampled.Evaluate(at.model, Slopes::kAll);
      AddPrice(
          price * E0, light.reflectance.measured, light,
          [&](const std::vector<double>& slope) { return reduction.Transpose(slope); }, &problem);
      step.MoveTo(problem, metric, reduction.Restrict(at.model.parameters()));
      linearized = true;
    }
    FactorModel stepped = at.model;
    std::ranges::copy(reduction.Expand(step.Solve(lambda).x), stepped.parameters().begin());
    const double error = sampled.Evaluate(stepped, Slopes::kNone).reflectance.Error();
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
