#include <Eigen/Core>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <optional>
#include <span>

#include "core/algebra/element_step.h"
#include "model/objective/gauge.h"
#include "solvers/sweep.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Anderson acceleration, type II (Anderson 1965; Walker and Ni 2011), of the map g that a sweep is:
// of the affine combinations of the last points g(u_k), the one whose residual f_k = g(u_k) - u_k,
// combined alike, is shortest. With differences dg_k, df_k of successive ones that is
//   g - sum_k gamma_k dg_k,  gamma = argmin |W (f - sum_k gamma_k df_k)|.
class AndersonMemory {
 public:
  explicit AndersonMemory(size_t size) : size_(size) {}

  // The step from g to the combined point; none as long as there is nothing to combine.
  // W: the metric's diagonal.
  std::optional<VectorXd> Step(const VectorXd& u, const VectorXd& g, const VectorXd& W) {
    const VectorXd f = g - u;
    if (last_g_.size() > 0) {
      dg_.push_front(g - last_g_);
      df_.push_front(f - last_f_);
      if (dg_.size() > size_) {
        dg_.pop_back();
        df_.pop_back();
      }
    }
    last_g_ = g;
    last_f_ = f;
    if (dg_.empty()) return std::nullopt;

    // Columns of one length, so that pivoting starts with the newest. Those that depend on earlier
    // ones get gamma = 0, which bounds the condition of the rest.
    constexpr double kSmallestPivot = 1e-8;
    const auto columns = static_cast<Eigen::Index>(dg_.size());
    MatrixXd A(g.size(), columns), B(g.size(), columns);
    for (Eigen::Index k = 0; k < columns; ++k) {
      A.col(k) = W.cwiseProduct(df_[k]);
      const double length = A.col(k).norm();
      const double scale = length > 0 ? 1 / length : 0;
      A.col(k) *= scale;
      B.col(k) = scale * dg_[k];
    }
    Eigen::ColPivHouseholderQR<MatrixXd> qr;
    qr.setThreshold(kSmallestPivot);
    qr.compute(A);
    return -(B * qr.solve(W.cwiseProduct(f)));
  }

  void Clear() {
    dg_.clear();
    df_.clear();
  }

 private:
  const size_t size_;
  VectorXd last_g_, last_f_;
  std::deque<VectorXd> dg_, df_;  // newest first
};

// Models as vectors that can be combined: in canonical form, as scale drifts between the factors
// from sweep to sweep, and with unobserved bins left out.
class Coordinates {
 public:
  // Unobserved bins of all models are those of `start`.
  Coordinates(const Objective& objective, const FactorModel& start)
      : coverage_(objective.coverage()), start_(start) {}

  VectorXd ToVector(FactorModel model) const {
    NormalizeScale(coverage_, &model);
    VectorXd x(model.parameters().size());
    for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = IsLive(k) ? model.parameters()[k] : 0;
    return x;
  }

  // Parameters below 0 become 0. None if one is too large for a model.
  std::optional<FactorModel> ToModel(const VectorXd& x) const {
    FactorModel model = start_;
    for (Eigen::Index k = 0; k < x.size(); ++k) {
      if (!IsLive(k)) continue;
      if (!(x[k] <= kMaxParameter)) return std::nullopt;
      model.parameters()[k] = std::max(x[k], 0.0);
    }
    return model;
  }

  // A diagonal metric that makes parts of a model commensurable: changes relative to the mean of d,
  // of a lobe's s or of a table, by the root of the weight that the data give a parameter.
  VectorXd Metric(const VectorXd& x) const {
    VectorXd W = VectorXd::Zero(x.size());
    for (const auto [begin, size] : start_.Parts()) {
      const double sum = x.segment(begin, size).sum();
      if (!(sum > 0)) continue;
      for (int k = begin; k < begin + size; ++k) W[k] = std::sqrt(coverage_[k]) * size / sum;
    }
    return W;
  }

 private:
  bool IsLive(Eigen::Index k) const { return coverage_[k] > 0; }

  const std::span<const double> coverage_;
  const FactorModel& start_;
};

struct Point {
  FactorModel model;
  double objective;
};

// Sweeps of awls_block, each followed by a step of Anderson acceleration along which E is searched:
// sweeps find a good direction, but the lobes resemble each other, and along a valley of E they
// creep. A step is taken only where E is lower than after the sweep alone, so E never rises;
// otherwise the memory starts afresh. De Sterck 2012 does so for alternating least squares of
// tensors.
class AwlsAccelerated : public Solver {
 private:
  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("awls_accelerated", objective, options, model);
    const std::unique_ptr<Sweep> sweep = MakeSweep(objective, &run.summary().phases);
    const FactorModel start = *model;
    const Coordinates coordinates(objective, start);
    AndersonMemory memory(static_cast<size_t>(options.memory));
    const auto evaluate = [&](const FactorModel& at) {
      const ScopedTimer timer = run.Time(&PhaseSeconds::evaluating);
      return objective.Value(at);
    };

    FactorModel current = start;
    for (bool go_on = run.Start(); go_on;) {
      const VectorXd u = coordinates.ToVector(current);
      sweep->SweepInBlocks(run.summary().trace.back(), options.on_element, &current);
      Point best{current, evaluate(current)};
      const VectorXd g = coordinates.ToVector(current);
      std::optional<VectorXd> step;
      {
        const ScopedTimer timer = run.Time(&PhaseSeconds::linear_algebra);
        step = memory.Step(u, g, coordinates.Metric(g));
      }
      const auto lowers = [&](double t) {
        const std::optional<FactorModel> candidate = coordinates.ToModel(g + t * *step);
        if (!candidate) return false;
        const double E = evaluate(*candidate);
        if (!(E < best.objective)) return false;
        best = {*candidate, E};
        return true;
      };
      if (step && !LowersAlong(lowers)) memory.Clear();
      current = best.model;
      go_on = run.Record(current, {.objective = best.objective});
    }
    return run.Finish();
  }

  // Tries the step, then longer ones while E falls; or else a quarter of it. E costs a tenth of a
  // sweep.
  template <typename Lowers>
  static bool LowersAlong(const Lowers& lowers) {
    constexpr double kLongest = 32;
    if (!lowers(1)) return lowers(0.25);
    for (double t = 2; t <= kLongest && lowers(t);) t *= 2;
    return true;
  }
};

}  // namespace

SolverEntry AwlsAcceleratedEntry() {
  return {.name = "awls_accelerated",
          .description = "awls_block with Anderson acceleration; E still never rises",
          .reference = "Walker and Ni 2011; De Sterck 2012",
          .options = {"memory"},
          .make = [] { return std::make_unique<AwlsAccelerated>(); }};
}

}  // namespace trilobe
