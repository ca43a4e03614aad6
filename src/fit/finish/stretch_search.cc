#include "fit/finish/stretch_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>

#include "core/algebra/symmetric_matrix.h"
#include "model/objective/lobes.h"
#include "model/objective/sample_derivatives.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/value_of.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {
namespace {

using Vector = std::vector<double>;

// The exponents e of a spec as a vector: along and across of each lobe, or of all together.
Vector ExponentsOf(const ModelSpec& spec) {
  Vector e;
  for (int m = 0; m < (spec.D.per_lobe ? spec.lobes : 1); ++m) {
    e.push_back(spec.stretches.of(m).along);
    e.push_back(spec.stretches.of(m).across);
  }
  return e;
}

Stretches StretchesOf(const Vector& e) {
  std::vector<Stretch> stretches;
  for (size_t k = 0; k < e.size(); k += 2) stretches.push_back({e[k], e[k + 1]});
  return Stretches(stretches);
}

// Terms of the exponents in the normal equations at a model.
struct ExponentEquations {
  Vector K_r;  // K'r. [exponents]
  Vector K_K;  // [exponents][exponents]
  Vector J_K;  // [parameters][exponents]
};

// d rho_c / de at one sample, by central differences of what each lobe reads of D.
class ExponentDerivatives {
 public:
  explicit ExponentDerivatives(const FactorModel& model)
      : model_(model), groups_(model.spec().D.per_lobe ? model.spec().lobes : 1) {}

  int size() const { return 2 * groups_; }

  // The stencils of D with each exponent a little higher and lower.
  void SetAngles(const HalfDiffAngles& angles) {
    const ModelSpec& spec = model_.spec();
    const Stretch::Place place(angles.theta_d, angles.phi_d);
    higher_.clear();
    lower_.clear();
    for (int g = 0; g < groups_; ++g) {
      const Stretch& at = spec.stretches.of(g);
      for (const auto& [along, across] : {std::pair{kStep, 0.0}, {0.0, kStep}}) {
        const Stretch higher{at.along + along, at.across + across};
        const Stretch lower{at.along - along, at.across - across};
        higher_.push_back(spec.d_axis.At(higher.ThetaH(angles.theta_h, place), 0));
        lower_.push_back(spec.d_axis.At(lower.ThetaH(angles.theta_h, place), 0));
      }
    }
  }

  void Set(const SampleStencils& at, int c, double* derivatives) const {
    const ModelSpec& spec = model_.spec();
    const ModelReads reads{model_, at};
    std::fill_n(derivatives, size(), 0.0);
    for (int m = 0; m < spec.lobes; ++m) {
      const double others =
          LobeValue(reads.s(m, c), 1.0, reads.F(m, c), reads.G(m, c)) / (2 * kStep);
      const int g = spec.D.per_lobe ? m : 0;
      for (int k = 2 * g; k < 2 * g + 2; ++k) {
        derivatives[k] += others * (higher_[k](model_.D(m, c)) - lower_[k](model_.D(m, c)));
      }
    }
  }

 private:
  static constexpr double kStep = 0.01;
  const FactorModel& model_;
  const int groups_;
  std::vector<Stencil> higher_, lower_;
};

// Sums over samples [begin, end).
ExponentEquations SumsOver(const Objective& objective, const FactorModel& model, int begin,
                           int end) {
  ExponentDerivatives exponents(model);
  const int size = exponents.size(), n = model.spec().num_parameters();
  ExponentEquations sums{Vector(size), Vector(static_cast<size_t>(size) * size),
                         Vector(static_cast<size_t>(size) * n)};
  SampleDerivatives parameters(n);
  Vector K(size);
  for (int j = begin; j < end; ++j) {
    const WeightedSample sample = objective.Sample(j);
    exponents.SetAngles(objective.samples().Angles(j));
    for (int c = 0; c < kChannels; ++c) {
      const double w = sample.weight[c];
      const double w_r = w * (UnclampedValue(model, sample.stencils, c) - sample.rho[c]);
      exponents.Set(sample.stencils, c, K.data());
      parameters.Set(model, sample.stencils, c);
      for (int k = 0; k < size; ++k) {
        sums.K_r[k] += K[k] * w_r;
        for (int l = 0; l < size; ++l) sums.K_K[k * size + l] += w * K[k] * K[l];
      }
      for (const int p : parameters.touched()) {
        double* const J_K = &sums.J_K[static_cast<size_t>(p) * size];
        const double w_J = w * parameters[p];
        for (int k = 0; k < size; ++k) J_K[k] += w_J * K[k];
      }
    }
  }
  return sums;
}

ExponentEquations Linearize(const Objective& objective, const FactorModel& model) {
  constexpr int kParts = 16;
  const int64_t size = objective.samples().size();
  std::array<ExponentEquations, kParts> parts;
  ParallelFor(kParts, objective.num_threads(), [&](int k) {
    parts[k] = SumsOver(objective, model, static_cast<int>(size * k / kParts),
                        static_cast<int>(size * (k + 1) / kParts));
  });
  for (int k = 1; k < kParts; ++k) {
    for (const auto sums :
         {&ExponentEquations::K_r, &ExponentEquations::K_K, &ExponentEquations::J_K}) {
      std::ranges::transform(parts[0].*sums, parts[k].*sums, (parts[0].*sums).begin(), std::plus());
    }
  }
  return std::move(parts[0]);
}

}  // namespace

StretchStepper::StretchStepper(const Objective& objective, const FactorModel& model)
    : model_(model) {
  const ExponentEquations sums = Linearize(objective, model);
  size_ = static_cast<int>(sums.K_r.size());
  QuadraticModel at;
  NormalEquations(objective).Evaluate(model, Hessian::kGaussNewton, &at);
  const size_t n = at.gradient.size();
  for (size_t p = 0; p < n; ++p) {
    const bool held = model.parameters()[p] == 0 && at.gradient[p] >= 0;
    if (at.squared_lengths[p] > 0 && !held) free_.push_back(static_cast<int>(p));
  }
  if (free_.empty()) return;  // of a black measurement, say
  const size_t f = free_.size();
  // Scale moves between the factors without a change of E: a little damping holds it.
  constexpr double kDamping = 1e-4;
  Vector A(f * f);
  for (size_t a = 0; a < f; ++a) {
    for (size_t b = 0; b < f; ++b) A[a * f + b] = at.H[free_[a] * n + free_[b]];
    A[a * f + a] *= 1 + kDamping;
  }
  const int rows = static_cast<int>(f), columns = 1 + size_;
  if (!FactorCholesky(rows, A.data(), objective.num_threads())) return;
  Vector half(f * columns);  // L^-1 of J'r and of the columns of J'K
  for (size_t a = 0; a < f; ++a) {
    half[a] = at.gradient[free_[a]];
    for (int k = 0; k < size_; ++k) half[(1 + k) * f + a] = sums.J_K[free_[a] * size_ + k];
  }
  SolveLower(rows, A.data(), columns, half.data());
  const auto dot = [&](int k, int l) {
    const double* const of_k = &half[k * f];
    return std::inner_product(of_k, of_k + f, &half[l * f], 0.0);
  };
  for (int k = 0; k < size_; ++k) {
    gradient_.push_back(sums.K_r[k] - dot(1 + k, 0));
    squared_lengths_.push_back(sums.K_K[k * size_ + k]);
    for (int l = 0; l < size_; ++l) H_.push_back(sums.K_K[k * size_ + l] - dot(1 + k, 1 + l));
  }
  for (int k = 0; k < columns; ++k) {
    SolveLowerTransposed(rows, A.data(), &half[k * f]);
    follows_.emplace_back(&half[k * f], &half[k * f] + f);
  }
}

Vector StretchStepper::ExponentStep(double lambda) const {
  Vector A = H_, step = gradient_;
  for (size_t k = 0; k < step.size(); ++k) {
    // A lobe that reflects nothing has exponents that change nothing.
    const double own = squared_lengths_[k];
    A[k * size_ + k] += own > 0 ? lambda * own : 1;
  }
  if (step.empty() || !FactorCholesky(size_, A.data())) return {};
  SolveLower(size_, A.data(), 1, step.data());
  SolveLowerTransposed(size_, A.data(), step.data());
  for (double& x : step) x = -x;
  return step;
}

std::optional<FactorModel> StretchStepper::Step(double lambda, double max_step,
                                                double follow) const {
  const Vector from = ExponentsOf(model_.spec()), step = ExponentStep(lambda);
  if (step.empty()) return std::nullopt;
  Vector exponents = from;
  for (size_t k = 0; k < from.size(); ++k) {
    const double moved = from[k] + std::clamp(step[k], -max_step, max_step);
    exponents[k] = std::clamp(std::round(100 * moved) / 100, -kMaxStretch, kMaxStretch);
  }
  if (exponents == from) return std::nullopt;
  FactorModel model = WithStretches(model_, StretchesOf(exponents));
  for (size_t a = 0; a < free_.size(); ++a) {
    double change = follows_[0][a];
    for (size_t k = 0; k < from.size(); ++k) {
      change += follows_[1 + k][a] * (exponents[k] - from[k]);
    }
    double& x = model.parameters()[free_[a]];
    x = std::max(x - follow * change, 0.0);
  }
  return model;
}

SteppedModel FitStretches(const Objective& objective, const FactorModel& fitted,
                          const StopCheck& stop) {
  constexpr int kJointSteps = 3;  // at each point
  constexpr int kMaxTries = 32;
  constexpr int kMaxRejected = 5;   // in a row
  constexpr double kMaxStep = 0.4;  // of an exponent
  constexpr double kMinLambda = 1e-4;
  constexpr double kSmall = 3e-3;  // a decrease of E, relative, that ends the search
  // Samples prepared for the stretches of the best point, from which steps begin.
  Objective at_best(objective, fitted.spec());
  SteppedModel best = JointSteps(at_best, fitted, kJointSteps, stop);
  double lambda = 1e-2;
  double follow = 1;  // how far the parameters follow a step
  int rejected = 0;
  std::optional<StretchStepper> stepper;
  for (int tries = 0; tries < kMaxTries && rejected < kMaxRejected && !stop(); ++tries) {
    if (!stepper) stepper.emplace(at_best, best.model);
    const std::optional<FactorModel> start = stepper->Step(lambda, kMaxStep, follow);
    if (!start) break;
    Objective at_trial(objective, start->spec());
    SteppedModel trial = JointSteps(at_trial, *start, kJointSteps, stop);
    if (trial.E < best.E) {
      const bool small = trial.E > (1 - kSmall) * best.E;
      best = std::move(trial);
      at_best = std::move(at_trial);
      stepper.reset();
      lambda = std::max(lambda / 4, kMinLambda);
      follow = std::min(2 * follow + 0.125, 1.0);
      rejected = 0;
      if (small) break;
    } else {
      // With the parameters left as they are, joint steps lower E in any case once the exponents
      // hardly move.
      if (follow == 0) lambda *= 8;
      follow = 0;
      ++rejected;
    }
  }
  return best;
}

}  // namespace trilobe
