#include "solvers/joint/nonnegative_step.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/algebra/element_step.h"
#include "core/algebra/symmetric_matrix.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// Holding and freeing at once converges in few rounds, but may cycle; holding alone ends.
constexpr int kExchangeRounds = 4;
constexpr int kMaxRounds = 10;
// A factor of n rows is used again while no more than n / 12 parameters have changed sides, which
// costs at most a quarter of a new one, if that has no tiles of zeros.
constexpr size_t kRowsForOneBorder = 12;
constexpr int kNone = -1;

using ConstVectorMap = Eigen::Map<const Eigen::VectorXd>;

// Eigen's own solve refers to the first number of the factor even where there is none.
Eigen::MatrixXd SolveBy(const Eigen::LLT<Eigen::MatrixXd>& factor, const Eigen::MatrixXd& b) {
  if (b.size() == 0) return b;
  return factor.solve(b);
}

}  // namespace

void NonnegativeStep::MoveTo(const QuadraticModel& at, std::span<const double> metric,
                             std::span<const double> x) {
  at_ = &at;
  x_.assign(x.begin(), x.end());
  const size_t n = x.size();
  for (auto* of_all : {&scale_, &unit_, &g_, &z_, &p_, &u_}) of_all->assign(n, 0.0);
  std::ranges::copy(metric, scale_.begin());
  binding_.assign(n, false);
  in_base_.assign(n, false);
  for (size_t k = 0; k < n; ++k) {
    if (!(scale_[k] > 0)) continue;
    unit_[k] = 1 / scale_[k];
    g_[k] = unit_[k] * at.gradient[k];
    z_[k] = scale_[k] * x[k];
    binding_[k] = z_[k] == 0 && g_[k] > 0;
  }
}

NonnegativeStep::Result NonnegativeStep::Solve(double lambda) {
  factored_ = false;
  Outcome outcome = Outcome::kChanged;
  for (int round = 0; outcome == Outcome::kChanged && round < kMaxRounds; ++round) {
    outcome = SolveFree(lambda, round < kExchangeRounds);
  }
  Result result{.x = x_};
  if (outcome == Outcome::kIndefinite) return result;
  const size_t n = x_.size();
  for (size_t k = 0; k < n; ++k) {
    if (unit_[k] == 0) continue;
    p_[k] = std::max(p_[k], -z_[k]);
    u_[k] = unit_[k] * p_[k];
    const double moved = z_[k] + p_[k];
    result.x[k] = moved > 0 ? std::min(moved / scale_[k], kMaxParameter) : 0;
  }
  const int size = static_cast<int>(n);
  const ConstVectorMap g(g_.data(), size), p(p_.data(), size), u(u_.data(), size);
  const std::vector<double> H_u = HTimesU([&](size_t k) { return u_[k] != 0; });
  result.predicted_decrease = -(g.dot(p) + u.dot(ConstVectorMap(H_u.data(), size)) / 2);
  return result;
}

// H u in the rows that are wanted, 0 in the others.
std::vector<double> NonnegativeStep::HTimesU(const std::function<bool(size_t)>& wanted) const {
  const size_t n = u_.size();
  const int size = static_cast<int>(n);
  const ConstVectorMap u(u_.data(), size);
  std::vector<double> H_u(n, 0.0);
  ForChunks(n, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      if (wanted(k)) H_u[k] = ConstVectorMap(&at_->H[k * n], size).dot(u);
    }
  });
  return H_u;
}

// Calls work(begin, end) for all of [0, count), on all threads.
void NonnegativeStep::ForChunks(size_t count,
                                const std::function<void(size_t, size_t)>& work) const {
  constexpr size_t kChunk = 64;
  ParallelFor(static_cast<int>((count + kChunk - 1) / kChunk), num_threads_,
              [&](int chunk) { work(chunk * kChunk, std::min((chunk + 1) * kChunk, count)); });
}

// Factors the scaled H + lambda of the parameters that are free now.
bool NonnegativeStep::Factor(double lambda) {
  const size_t n = x_.size();
  base_.clear();
  units_.clear();
  for (size_t i = 0; i < n; ++i) {
    const size_t k = order_.empty() ? i : order_[i];
    in_base_[k] = unit_[k] != 0 && !binding_[k];
    if (!in_base_[k]) continue;
    base_.push_back(k);
    units_.push_back(unit_[k]);
  }
  const size_t size = base_.size();
  L_.resize(size * size);
  ForChunks(size, [&](size_t begin, size_t end) {
    for (size_t j = begin; j < end; ++j) {
      const double* const H_k = &at_->H[base_[j] * n];
      double* const column = &L_[j * size];
      for (size_t i = j; i < size; ++i) column[i] = units_[j] * H_k[base_[i]] * units_[i];
      column[j] += lambda;
    }
  });
  column_of_.assign(n, kNone);
  solved_.clear();
  return FactorCholesky(static_cast<int>(size), L_.data(), num_threads_);
}

// Finds the columns of U and V, below, that were not asked for before.
void NonnegativeStep::SolveBorder() {
  const size_t size = base_.size(), n = x_.size();
  std::vector<size_t> before;  // the rows that are 0 before the first that is not, by column
  const size_t first = solved_.size() / size;
  for (const size_t j : removed_) {
    int& column = column_of_[base_[j]];
    if (column != kNone) continue;
    column = static_cast<int>(first + before.size());
    before.push_back(j);
    solved_.resize(solved_.size() + size, 0.0);
    solved_[solved_.size() - size + j] = 1;
  }
  for (const size_t k : added_) {
    if (column_of_[k] != kNone) continue;
    column_of_[k] = static_cast<int>(first + before.size());
    before.push_back(0);
    solved_.resize(solved_.size() + size);
    double* const V_k = &solved_[solved_.size() - size];
    for (size_t j = 0; j < size; ++j) V_k[j] = -unit_[k] * at_->H[k * n + base_[j]] * units_[j];
  }
  constexpr size_t kColumns = 8;
  const size_t count = before.size();
  ParallelFor(static_cast<int>((count + kColumns - 1) / kColumns), num_threads_, [&](int chunk) {
    const size_t begin = chunk * kColumns, end = std::min(begin + kColumns, count);
    const size_t row = *std::min_element(before.begin() + begin, before.begin() + end);
    SolveLower(static_cast<int>(size), L_.data(), static_cast<int>(end - begin),
               &solved_[(first + begin) * size], static_cast<int>(row));
  });
}

// Sets p by the present active set. That differs from the one of the factor LL' = A by the
// parameters R that are held since, at p = -z, and N that are free since. With multipliers mu of
// the former, c what the right-hand side would be, E_R columns of the identity and B = A_.N,
//   A p + B p_N = c + E_R mu,   p_R = -z_R,   B'p + A_NN p_N = c_N,
// and with  y = L^-1 c,  U = L^-1 E_R,  V = -L^-1 B  what is left is small:
//   U'U mu + U'V p_N = -z_R - U'y,   (A_NN - V'V) p_N - V'U mu = c_N + V'y,
//   p = L^-T (y + U mu + V p_N).
// False if the matrix of the free parameters is not positive definite.
bool NonnegativeStep::SetStep(double lambda) {
  const size_t n = x_.size();
  removed_.clear();
  added_.clear();
  for (size_t k = 0; k < n; ++k) {
    if (unit_[k] != 0 && !binding_[k] && !in_base_[k]) added_.push_back(k);
  }
  for (size_t j = 0; j < base_.size(); ++j) {
    if (binding_[base_[j]]) removed_.push_back(j);
  }
  if (!factored_ || kRowsForOneBorder * (removed_.size() + added_.size()) > base_.size()) {
    removed_.clear();
    added_.clear();
    factored_ = Factor(lambda);
    if (!factored_) return false;
  }

  // Most parameters that have been held all along are at 0 already.
  Eigen::VectorXd H_u = Eigen::VectorXd::Zero(static_cast<int>(n));
  for (size_t k = 0; k < n; ++k) {
    p_[k] = unit_[k] != 0 && binding_[k] && !in_base_[k] ? -z_[k] : 0;
    u_[k] = unit_[k] * p_[k];
    if (p_[k] != 0) H_u += u_[k] * ConstVectorMap(&at_->H[k * n], static_cast<int>(n));
  }
  const auto right_hand_side = [&](size_t k) { return -(g_[k] + unit_[k] * H_u[k]); };
  const int size = static_cast<int>(base_.size());
  const int num_removed = static_cast<int>(removed_.size());
  const int num_added = static_cast<int>(added_.size());
  Eigen::VectorXd y(size), b_R(num_removed), b_N(num_added);
  Eigen::MatrixXd A_NN(num_added, num_added);
  for (int j = 0; j < size; ++j) y(j) = right_hand_side(base_[j]);
  SolveLower(size, L_.data(), 1, y.data());
  if (num_removed + num_added > 0) {
    SolveBorder();
    Eigen::MatrixXd U(size, num_removed), V(size, num_added);
    const auto column = [&](size_t k) {
      return ConstVectorMap(&solved_[static_cast<size_t>(column_of_[k]) * size], size);
    };
    for (int r = 0; r < num_removed; ++r) {
      const size_t k = base_[removed_[r]];
      U.col(r) = column(k);
      b_R(r) = -z_[k];
    }
    for (int a = 0; a < num_added; ++a) {
      const size_t k = added_[a];
      const double* const H_k = &at_->H[k * n];
      V.col(a) = column(k);
      for (int e = 0; e < num_added; ++e) A_NN(e, a) = unit_[k] * H_k[added_[e]] * unit_[added_[e]];
      A_NN(a, a) += lambda;
      b_N(a) = right_hand_side(k);
    }
    b_R -= U.transpose() * y;
    b_N += V.transpose() * y;
    const Eigen::MatrixXd U_V = U.transpose() * V;
    const Eigen::LLT<Eigen::MatrixXd> of_R(U.transpose() * U);
    const Eigen::LLT<Eigen::MatrixXd> of_N(A_NN - V.transpose() * V +
                                           U_V.transpose() * SolveBy(of_R, U_V));
    if (of_R.info() != Eigen::Success || of_N.info() != Eigen::Success) return false;
    const Eigen::VectorXd p_N = SolveBy(of_N, b_N + U_V.transpose() * SolveBy(of_R, b_R));
    y += U * SolveBy(of_R, b_R - U_V * p_N) + V * p_N;
    for (int a = 0; a < num_added; ++a) p_[added_[a]] = p_N(a);
  }
  SolveLowerTransposed(size, L_.data(), y.data());
  for (int j = 0; j < size; ++j) p_[base_[j]] = y(j);
  for (const size_t j : removed_) p_[base_[j]] = -z_[base_[j]];
  for (size_t k = 0; k < n; ++k) u_[k] = unit_[k] * p_[k];
  return ConstVectorMap(p_.data(), static_cast<int>(n)).allFinite();
}

// Sets p by the present active set, then changes that.
NonnegativeStep::Outcome NonnegativeStep::SolveFree(double lambda, bool release) {
  if (!SetStep(lambda)) return Outcome::kIndefinite;
  std::vector<double> H_u;
  if (release) H_u = HTimesU([&](size_t k) { return unit_[k] != 0 && binding_[k]; });
  bool changed = false;
  for (size_t k = 0; k < x_.size(); ++k) {
    if (unit_[k] == 0) continue;
    if (!binding_[k]) {
      if (z_[k] + p_[k] >= 0) continue;
      binding_[k] = changed = true;
    } else if (release && g_[k] + unit_[k] * H_u[k] + lambda * p_[k] < 0) {
      binding_[k] = false;
      changed = true;
    }
  }
  return changed ? Outcome::kChanged : Outcome::kRight;
}

}  // namespace trilobe
