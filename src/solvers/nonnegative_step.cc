#include "trilobe/solvers/nonnegative_step.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "trilobe/solvers/element_step.h"

namespace trilobe {

class NonnegativeStep::Impl {
 public:
  Impl(const QuadraticModel& at, std::span<const double> x)
      : x_(x.begin(), x.end()), binding_(x.size(), false) {
    const int n = static_cast<int>(x.size());
    const Eigen::Map<const Eigen::MatrixXd> H(at.H.data(), n, n);
    const Eigen::Map<const Eigen::VectorXd> squared_lengths(at.squared_lengths.data(), n);
    for (int k = 0; k < n; ++k) {
      if (squared_lengths(k) > 0) moving_.push_back(k);
    }
    scale_ = squared_lengths(moving_).cwiseSqrt();
    const Eigen::VectorXd inverse = scale_.cwiseInverse();
    H_ = inverse.asDiagonal() * H(moving_, moving_).eval() * inverse.asDiagonal();
    const Eigen::Map<const Eigen::VectorXd> gradient(at.gradient.data(), n);
    g_ = inverse.cwiseProduct(gradient(moving_));
    const Eigen::Map<const Eigen::VectorXd> values(x_.data(), n);
    z_ = scale_.cwiseProduct(values(moving_));
    for (int i = 0; i < g_.size(); ++i) binding_[moving_[i]] = z_(i) == 0 && g_(i) > 0;
  }

  Result Solve(double lambda) {
    Result result;
    const int size = static_cast<int>(g_.size());
    Eigen::VectorXd p = Eigen::VectorXd::Zero(size);
    for (int round = 0; round < kMaxRounds; ++round) {
      if (!SolveFree(lambda, round < kExchangeRounds, &p)) break;
    }
    p = p.cwiseMax(-z_);
    if (!p.allFinite()) p.setZero();
    result.predicted_decrease = -(g_.dot(p) + p.dot(H_ * p) / 2);
    result.x = x_;
    for (int i = 0; i < size; ++i) {
      const double moved = z_(i) + p(i);
      result.x[moving_[i]] = moved > 0 ? std::min(moved / scale_(i), kMaxParameter) : 0;
    }
    return result;
  }

  const std::vector<bool>& binding() const { return binding_; }
  void SetBinding(std::vector<bool> binding) { binding_ = std::move(binding); }

 private:
  // Holding and freeing at once converges in few rounds, but may cycle; holding alone ends.
  static constexpr int kExchangeRounds = 4;
  static constexpr int kMaxRounds = 10;

  // Sets p by the present active set, then changes that; false if it was right already.
  bool SolveFree(double lambda, bool release, Eigen::VectorXd* p) {
    std::vector<int> free, held;
    for (int i = 0; i < g_.size(); ++i) (binding_[moving_[i]] ? held : free).push_back(i);
    const int num_free = static_cast<int>(free.size());
    // With the held parameters at 0, what they ask of the free ones: g + H p.
    p->setZero();
    for (const int i : held) (*p)(i) = -z_(i);
    Eigen::VectorXd gradient = g_ + H_ * *p;
    Eigen::MatrixXd A(num_free, num_free);
    Eigen::VectorXd step(num_free);
    for (int k = 0; k < num_free; ++k) {
      for (int l = 0; l < num_free; ++l) A(l, k) = H_(free[l], free[k]);
      A(k, k) += lambda;
      step(k) = -gradient(free[k]);
    }
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(A);
    if (llt.info() != Eigen::Success) {
      p->setConstant(std::numeric_limits<double>::quiet_NaN());
      return false;
    }
    llt.solveInPlace(step);
    bool changed = false;
    for (int k = 0; k < num_free; ++k) {
      const int i = free[k];
      (*p)(i) = step(k);
      if (z_(i) + step(k) >= 0) continue;
      binding_[moving_[i]] = changed = true;
    }
    if (!release || held.empty()) return changed;
    gradient = g_ + H_ * *p + lambda * *p;
    for (const int i : held) {
      if (gradient(i) >= 0) continue;
      binding_[moving_[i]] = false;
      changed = true;
    }
    return changed;
  }

  std::vector<double> x_;
  std::vector<bool> binding_;      // [num_parameters]
  std::vector<int> moving_;        // parameters whose column of J is not 0
  Eigen::VectorXd scale_, g_, z_;  // of those, scaled
  Eigen::MatrixXd H_;
};

NonnegativeStep::NonnegativeStep(const QuadraticModel& at, std::span<const double> x)
    : impl_(std::make_unique<Impl>(at, x)) {}
NonnegativeStep::~NonnegativeStep() = default;
NonnegativeStep::Result NonnegativeStep::Solve(double lambda) { return impl_->Solve(lambda); }
const std::vector<bool>& NonnegativeStep::binding() const { return impl_->binding(); }
void NonnegativeStep::SetBinding(std::vector<bool> binding) {
  impl_->SetBinding(std::move(binding));
}

}  // namespace trilobe
