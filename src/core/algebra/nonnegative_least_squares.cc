#include "core/algebra/nonnegative_least_squares.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/algebra/element_step.h"

namespace trilobe {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
// Far above the rounding error of H, so that flat directions do not move, and too small to slow
// other directions.
constexpr double kPenalty = 0x1p-30;

// No allocations: there are thousands of these small problems in a sweep.
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor,
                             kMaxNonnegativeUnknowns, kMaxNonnegativeUnknowns>;
using Vector =
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxNonnegativeUnknowns, 1>;
using ConstMatrix = Eigen::Map<const Matrix>;
using ConstVector = Eigen::Map<const Vector>;

// delta'C delta - 2 h'delta over delta >= lower, lower <= 0, C positive definite.
class ActiveSet {
 public:
  ActiveSet(const Matrix& C, const Vector& h, const Vector& lower)
      : C_(C), h_(h), lower_(lower), delta_(Vector::Zero(h.size())) {
    for (int k = 0; k < h.size(); ++k) free_[k] = lower[k] < 0;
  }

  // The value decreases from one minimum over the free unknowns to the next, so no set of them
  // recurs; the limit guards against rounding and ties.
  Vector Solve() {
    for (int step = 0; step < 4 * h_.size() + 4; ++step) {
      if (MoveToFreeMinimum() && !FreeOne()) break;
    }
    return delta_;
  }

 private:
  // Moves towards the minimum over the free unknowns until one reaches its bound, where it is then
  // held. True if the minimum was reached.
  bool MoveToFreeMinimum() {
    const int n = static_cast<int>(h_.size());
    int index[kMaxNonnegativeUnknowns], count = 0;
    for (int k = 0; k < n; ++k) {
      if (free_[k]) index[count++] = k;
    }
    if (count == 0) return true;
    const Vector descent = h_ - C_ * delta_;
    Matrix C_free(count, count);
    Vector step(count);
    for (int i = 0; i < count; ++i) {
      step[i] = descent[index[i]];
      for (int j = 0; j < count; ++j) C_free(i, j) = C_(index[i], index[j]);
    }
    C_free.llt().solveInPlace(step);
    double length = 1;
    int blocking = -1;
    for (int i = 0; i < count; ++i) {
      const double room = lower_[index[i]] - delta_[index[i]];
      if (step[i] < room && room / step[i] <= length) {
        length = room / step[i];
        blocking = index[i];
      }
    }
    for (int i = 0; i < count; ++i) {
      delta_[index[i]] = std::max(lower_[index[i]], delta_[index[i]] + length * step[i]);
    }
    if (blocking < 0) return true;
    free_[blocking] = false;
    delta_[blocking] = lower_[blocking];
    return false;
  }

  // Frees the bounded unknown whose increase lowers the value most; false if there is none.
  bool FreeOne() {
    const Vector descent = h_ - C_ * delta_;
    const Vector rounding = 4 * kEpsilon * (h_.cwiseAbs() + C_.cwiseAbs() * delta_.cwiseAbs());
    int best = -1;
    for (int k = 0; k < h_.size(); ++k) {
      if (free_[k] || !(descent[k] > rounding[k])) continue;
      if (best < 0 || descent[k] > descent[best]) best = k;
    }
    if (best < 0) return false;
    free_[best] = true;
    return true;
  }

  const Matrix& C_;
  const Vector& h_;
  const Vector& lower_;
  Vector delta_;
  bool free_[kMaxNonnegativeUnknowns] = {};
};

// True if the decrease exceeds the rounding errors of its own terms and of g.
bool Lowers(const ConstMatrix& H, const ConstVector& g, double E, const Vector& delta) {
  double change = 0, terms = 0;
  for (int k = 0; k < delta.size(); ++k) {
    double curvature = 0, curvature_terms = 0;
    for (int l = 0; l < delta.size(); ++l) {
      const double term = H(k, l) * delta[l];
      curvature += term;
      curvature_terms += std::abs(term);
    }
    change += delta[k] * (curvature - 2 * g[k]);
    terms += std::abs(delta[k]) * (curvature_terms + 2 * std::abs(g[k]));
  }
  constexpr double kUnresolved = 16 * kEpsilon * kEpsilon / kPenalty;
  return change + 4 * kEpsilon * terms + kUnresolved * E < 0;
}

void MinimizeOneByOne(const ConstMatrix& H, Vector g, std::span<double> x) {
  for (int k = 0; k < g.size(); ++k) {
    const double before = x[k];
    x[k] = BestElement(before, {.c1 = -2 * g[k], .c2 = H(k, k)});
    g -= (x[k] - before) * H.col(k);
  }
}

}  // namespace

void SolveNonnegativeLeastSquares(std::span<const double> H_values,
                                  std::span<const double> g_values, double E, std::span<double> x) {
  const int n = static_cast<int>(x.size());
  const ConstMatrix H(H_values.data(), n, n);
  const ConstVector g(g_values.data(), n);
  // Scaled so that the diagonal of H is 1. Unknowns without influence on E are held.
  Matrix C(n, n);
  Vector scale(n), h(n), lower(n);
  for (int k = 0; k < n; ++k) {
    const bool used = H(k, k) > 0;
    scale[k] = used ? 1 / std::sqrt(H(k, k)) : 0;
    lower[k] = used ? -x[k] / scale[k] : 0;
    h[k] = g[k] * scale[k];
  }
  for (int k = 0; k < n; ++k) {
    for (int l = 0; l < n; ++l) C(k, l) = H(k, l) * scale[k] * scale[l];
    C(k, k) = 1 + kPenalty;
  }
  const Vector delta = ActiveSet(C, h, lower).Solve();
  Vector moved(n), solution(n);
  for (int k = 0; k < n; ++k) {
    solution[k] = delta[k] > lower[k] ? x[k] + delta[k] * scale[k] : scale[k] > 0 ? 0 : x[k];
    solution[k] = std::max(solution[k], 0.0);
    moved[k] = solution[k] - x[k];
  }
  if (solution.maxCoeff() <= kMaxParameter && Lowers(H, g, E, moved)) {
    std::copy_n(solution.data(), n, x.data());
  } else {
    MinimizeOneByOne(H, g, x);
  }
}

}  // namespace trilobe
