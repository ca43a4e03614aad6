#include "fit/finish/light_refit.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/algebra/symmetric_matrix.h"
#include "model/measurement/albedo_rule.h"
#include "model/objective/sample_derivatives.h"
#include "solvers/joint/reduction.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/prepared_model.h"
#include "trilobe/solvers/sums/normal_equations.h"

namespace trilobe {
namespace {

constexpr int kRefitAzimuths = 36;  // of half vectors: the tables are smooth in them
constexpr double kAim = 0.99;       // of the limit
constexpr double kKept = 1.0;       // of the limit, where a bound is kept

// The light that is reflected from the directions of bounds, and how it exceeds.
class BoundedLight {
 public:
  BoundedLight(const std::vector<LightBound>& bounds, int num_threads)
      : bounds_(bounds), num_threads_(num_threads) {}

  struct Excess {
    double squares = 0, largest = 0;  // of log(A / (kAim limit)); of A / limit
  };
  Excess operator()(const FactorModel& model) const {
    Excess excess;
    const std::vector<Rgb> albedos = Albedos(model);
    for (size_t k = 0; k < bounds_.size(); ++k) {
      for (int c = 0; c < kChannels; ++c) {
        excess.squares += std::pow(Residual(k, albedos[k], c), 2);
      }
      excess.largest = std::max(excess.largest, ExcessOf(albedos[k], bounds_[k].limit));
    }
    return excess;
  }

  // Adds price times the squares, by Gauss and Newton.
  void AddTo(double price, const FactorModel& model, QuadraticModel* at) const {
    const std::vector<Rgb> albedos = Albedos(model);
    std::vector<size_t> exceeding;
    for (size_t k = 0; k < bounds_.size(); ++k) {
      if (ExcessOf(albedos[k], bounds_[k].limit) > kAim) exceeding.push_back(k);
    }
    std::vector<Slopes> slopes(exceeding.size());
    ParallelFor(static_cast<int>(exceeding.size()), num_threads_,
                [&](int j) { slopes[j] = SlopesAt(model, bounds_[exceeding[j]].at); });
    // Rows of the Jacobian of the residuals log(A / limit): the slope of log A is that of A over A.
    const auto n = static_cast<Eigen::Index>(model.parameters().size());
    Eigen::MatrixXd rows(n, kChannels * exceeding.size());
    Eigen::Index count = 0;
    Eigen::Map<Eigen::VectorXd> gradient(at->gradient.data(), n);
    for (size_t j = 0; j < exceeding.size(); ++j) {
      for (int c = 0; c < kChannels; ++c) {
        const size_t k = exceeding[j];
        const double residual = Residual(k, albedos[k], c);
        if (!(residual > 0)) continue;
        rows.col(count) = Eigen::Map<const Eigen::VectorXd>(slopes[j][c].data(), n) *
                          (std::sqrt(price) / albedos[k][c]);
        gradient += std::sqrt(price) * residual * rows.col(count);
        ++count;
      }
    }
    Eigen::Map<Eigen::MatrixXd> H(at->H.data(), n, n);
    H.noalias() += rows.leftCols(count) * rows.leftCols(count).transpose();
  }

 private:
  using Slopes = std::array<std::vector<double>, kChannels>;

  double Residual(size_t k, const Rgb& albedo, int c) const {
    const double aim = kAim * bounds_[k].limit[c];
    return albedo[c] > aim ? std::log(albedo[c] / aim) : 0;
  }

  static DirectionPair Turned(const DirectionPair& pair, double phi) {
    if (phi == 0) return pair;
    return {TurnedAboutNormal(pair.wi, phi), TurnedAboutNormal(pair.wo, phi)};
  }

  std::vector<Rgb> Albedos(const FactorModel& model) const {
    const PreparedModel<double> prepared(model);
    std::vector<Rgb> albedos(bounds_.size());
    ParallelFor(static_cast<int>(bounds_.size()), num_threads_, [&](int k) {
      Visit(model.spec(), bounds_[k].at, [&](const DirectionPair& pair, double weight) {
        const Rgb value = prepared.Value(pair.wi, pair.wo);
        for (int c = 0; c < kChannels; ++c) albedos[k][c] += weight * value[c];
      });
    });
    return albedos;
  }

  // Calls visit(pair, weight), with the normalisation of the rule. Half of the azimuths mirror the
  // others where no azimuth matters.
  template <typename Visitor>
  static void Visit(const ModelSpec& spec, const PolarAngles& from, const Visitor& visit) {
    const bool half = !spec.anisotropic();
    const double scale = (half ? 2 : 1) * 2 * kPi / kRefitAzimuths;
    VisitReflected(from.theta, kRefitAzimuths, [&](const DirectionPair& pair, double weight) {
      if (half && pair.wo[1] < 0) return;
      visit(Turned(pair, from.phi), scale * weight);
    });
  }

  static Slopes SlopesAt(const FactorModel& model, const PolarAngles& from) {
    const ModelSpec& spec = model.spec();
    Slopes slopes;
    for (auto& slope : slopes) slope.assign(spec.num_parameters(), 0.0);
    Visit(spec, from, [&](const DirectionPair& pair, double weight) {
      const SampleStencils stencils = spec.anisotropic()
                                          ? ScatteredStencils(spec, ToSphericalAngles(pair))
                                          : ScatteredStencils(spec, ToHalfDiff(pair));
      for (int c = 0; c < kChannels; ++c) {
        SampleDerivatives::Visit(model, stencils, c, [&](int parameter, double value) {
          slopes[c][parameter] += weight * value;
        });
      }
    });
    return slopes;
  }

  const std::vector<LightBound>& bounds_;
  const int num_threads_;
};

}  // namespace

FactorModel RefitWithinBounds(const std::vector<LightBound>& bounds, const Objective& objective,
                              const TableLayout& layout, const FactorModel& model,
                              const StopCheck& stop) {
  constexpr double kPrices[] = {1e-2, 1e-1, 1, 10};  // of E of a black model
  constexpr double kStay = 1e-6;                     // epsilon, the same
  constexpr int kSteps = 20;                         // with each price
  constexpr double kFirstDamping = 1e-3, kFall = 0.3, kRise = 5, kMostDamping = 1e4;  // of the
  // largest diagonal entry
  constexpr double kMaxMove = 1.5, kHardlyLower = 1e-2;
  CheckSameSpec(model.spec(), objective.spec());
  CheckLayout(layout, model.spec());
  const int num_threads = objective.num_threads();
  const double energy = objective.MeasuredEnergy();
  const BoundedLight light(bounds, num_threads);
  const Reduction reduction(model.spec(), layout);
  const bool is_full = layout == TableLayout::Full(model.spec());
  const std::vector<double> start = reduction.Restrict(model.parameters());
  const size_t n = start.size();
  NormalEquations equations(objective);
  QuadraticModel at;
  FactorModel current = model;
  std::vector<double> moved(n, 0.0);  // y - y(model)
  const auto model_at = [&](const std::vector<double>& moves) {
    std::vector<double> y(n);
    for (size_t k = 0; k < n; ++k) y[k] = start[k] * std::exp(moves[k]);
    FactorModel trial = model;
    std::ranges::copy(reduction.Expand(y), trial.parameters().begin());
    return trial;
  };
  const auto squared = [](const std::vector<double>& moves) {
    double sum = 0;
    for (const double x : moves) sum += x * x;
    return sum;
  };
  for (const double price : kPrices) {
    BoundedLight::Excess excess = light(current);
    if (excess.largest <= kKept) break;
    const auto total = [&](double E, const BoundedLight::Excess& of, const auto& moves) {
      return E + price * energy * of.squares + kStay * energy * squared(moves);
    };
    double lowest = total(objective.Value(current), excess, moved);
    double damping = kFirstDamping, most = 0;
    bool linearized = false;
    for (int k = 0; k < kSteps && damping < kMostDamping && !stop(); ++k) {
      if (!linearized) {
        equations.Evaluate(current, Hessian::kGaussNewton, &at);
        light.AddTo(price * energy, current, &at);
        if (!is_full) at = reduction(at);
        const std::vector<double> y = reduction.Restrict(current.parameters());
        for (size_t a = 0; a < n; ++a) {
          at.gradient[a] *= y[a];
          double* const row = &at.H[a * n];
          for (size_t b = 0; b < n; ++b) row[b] *= y[a] * y[b];
          row[a] += std::max(0.0, at.gradient[a]) + kStay * energy;
          at.gradient[a] += kStay * energy * moved[a];
        }
        most = 0;
        for (size_t a = 0; a < n; ++a) most = std::max(most, at.H[a * n + a]);
        linearized = true;
      }
      std::vector<double> factor = at.H, step(n);
      for (size_t a = 0; a < n; ++a) {
        factor[a * n + a] += damping * most;
        step[a] = -at.gradient[a];
      }
      if (!FactorCholesky(static_cast<int>(n), factor.data(), num_threads)) {
        damping *= kRise;
        continue;
      }
      SolveLower(static_cast<int>(n), factor.data(), 1, step.data());
      SolveLowerTransposed(static_cast<int>(n), factor.data(), step.data());
      double longest = 0;
      for (const double move : step) longest = std::max(longest, std::abs(move));
      if (longest > kMaxMove) {
        damping *= kRise;
        continue;
      }
      std::vector<double> moves = moved;
      for (size_t a = 0; a < n; ++a) moves[a] += step[a];
      FactorModel trial = model_at(moves);
      const BoundedLight::Excess then = light(trial);
      const double lower = total(objective.Value(trial), then, moves);
      if (!(lower < lowest)) {
        damping *= kRise;
        continue;
      }
      const bool small = lower > (1 - kHardlyLower) * lowest;
      lowest = lower;
      excess = then;
      current = std::move(trial);
      moved = std::move(moves);
      damping *= kFall;
      linearized = false;
      if (small) break;
    }
  }
  return current;
}

}  // namespace trilobe
