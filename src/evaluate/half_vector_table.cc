#include "trilobe/evaluate/half_vector_table.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "math/linear_density.h"
#include "trilobe/base/error.h"
#include "trilobe/math/angles.h"

namespace trilobe {
namespace {

// Nodes of s that there may be.
constexpr int kMaxS = 33;

// Bins that y is looked up by: of its fourth root, which is about that of theta_h's square root.
constexpr int kFirsts = 512;

template <typename Real>
Real FourthRoot(Real y) {
  return std::sqrt(std::sqrt(std::clamp(y, Real{0}, Real{1})));
}

// Which of the intervals between ascending nodes a number is in.
template <typename Real>
int IntervalOf(const std::vector<Real>& nodes, Real x) {
  const auto upper = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, x);
  return static_cast<int>(upper - nodes.begin()) - 1;
}

}  // namespace

template <typename Real>
HalfVectorTable<Real>::HalfVectorTable(const Nodes& nodes, const std::vector<float>& values)
    : y_(nodes.y.begin(), nodes.y.end()),
      theta_i_(nodes.theta_i.begin(), nodes.theta_i.end()),
      num_s_(nodes.s),
      num_phi_i_(nodes.phi_i),
      values_(values) {
  const int rows = static_cast<int>(y_.size());
  const int count = static_cast<int>(theta_i_.size()) * num_phi_i_;
  if (num_s_ < 2 || num_s_ > kMaxS) throw Error("a table needs 2 to 33 nodes of s");
  largest_step_ = static_cast<int>(std::bit_floor(static_cast<unsigned>(rows)));
  for (int k = 0; k < kFirsts; ++k) {
    const double root = static_cast<double>(k) / (kFirsts - 1);
    first_.push_back(IntervalOf(y_, static_cast<Real>(root * root * root * root)));
    // The bin below begins a little earlier by rounding.
    first_.back() = std::max(first_.back() - 1, 0);
  }
  for (int node = 0; node < count; ++node) {
    double sum = 0, before = 0;
    for (int row = 0; row < rows; ++row) {
      const float* const at = Row(node, row);
      double of_row = -0.5 * (at[0] + at[num_s_ - 1]);
      for (int k = 0; k < num_s_; ++k) of_row += at[k];
      of_row /= num_s_ - 1;
      if (row > 0) sum += (before + of_row) / 2 * (nodes.y[row] - nodes.y[row - 1]);
      of_row_.push_back(static_cast<Real>(of_row));
      cumulated_.push_back(static_cast<Real>(sum));
      before = of_row;
    }
  }
}

template <typename Real>
typename HalfVectorTable<Real>::Condition HalfVectorTable<Real>::At(Real theta_i, Real phi_i,
                                                                    Real end) const {
  Condition at;
  const auto add = [&](int node, Real weight) {
    if (weight == 0) return;
    at.node[at.count] = node;
    at.weight[at.count++] = weight;
  };
  const int ring = IntervalOf(theta_i_, theta_i);
  const Real t = std::clamp((theta_i - theta_i_[ring]) / (theta_i_[ring + 1] - theta_i_[ring]),
                            Real{0}, Real{1});
  if (num_phi_i_ == 1) {
    add(ring, 1 - t);
    add(ring + 1, t);
  } else {
    const Real turns = phi_i * static_cast<Real>(0.5 / kPi);
    const Real x = (turns - std::floor(turns)) * static_cast<Real>(num_phi_i_);
    const int low = std::min(static_cast<int>(x), num_phi_i_ - 1), high = (low + 1) % num_phi_i_;
    const Real f = x - static_cast<Real>(low);
    add(ring * num_phi_i_ + low, (1 - t) * (1 - f));
    add(ring * num_phi_i_ + high, (1 - t) * f);
    add((ring + 1) * num_phi_i_ + low, t * (1 - f));
    add((ring + 1) * num_phi_i_ + high, t * f);
  }
  at.end = end;
  const int row = IntervalOfY(end);
  const Real part = end - y_[row], width = y_[row + 1] - y_[row];
  const Real from = OfRow(at, row), to = OfRow(at, row + 1);
  at.total = Cumulated(at, row) + part * (from + (to - from) * part / (2 * width));
  return at;
}

template <typename Real>
int HalfVectorTable<Real>::IntervalOfY(Real y) const {
  int row = first_[static_cast<int>(FourthRoot(y) * (kFirsts - 1))];
  while (row + 2 < static_cast<int>(y_.size()) && y_[row + 1] <= y) ++row;
  return row;
}

template <typename Real>
Real HalfVectorTable<Real>::OfRow(const Condition& at, int row) const {
  Real sum = 0;
  for (int k = 0; k < at.count; ++k) {
    sum += at.weight[k] * of_row_[static_cast<size_t>(at.node[k]) * y_.size() + row];
  }
  return sum;
}

template <typename Real>
Real HalfVectorTable<Real>::Cumulated(const Condition& at, int row) const {
  Real sum = 0;
  for (int k = 0; k < at.count; ++k) {
    sum += at.weight[k] * cumulated_[static_cast<size_t>(at.node[k]) * y_.size() + row];
  }
  return sum;
}

template <typename Real>
Real HalfVectorTable<Real>::Value(const Condition& at, Real y, Real s) const {
  if (y > at.end) return 0;
  const int row = IntervalOfY(y);
  const Real t = std::clamp((y - y_[row]) / (y_[row + 1] - y_[row]), Real{0}, Real{1});
  const Real x = std::clamp(s, Real{0}, Real{1}) * static_cast<Real>(num_s_ - 1);
  const int k = std::min(static_cast<int>(x), num_s_ - 2);
  const Real f = x - static_cast<Real>(k);
  Real sum = 0;
  for (int n = 0; n < at.count; ++n) {
    const float *low = Row(at.node[n], row) + k, *high = low + num_s_;
    sum += at.weight[n] *
           ((1 - t) * ((1 - f) * low[0] + f * low[1]) + t * ((1 - f) * high[0] + f * high[1]));
  }
  return sum;
}

template <typename Real>
typename HalfVectorTable<Real>::Sample HalfVectorTable<Real>::Draw(const Condition& at, Real u_y,
                                                                   Real u_s) const {
  // The interval of y that has the part u_y of the integral, by steps that no branch waits for.
  const Real wanted = u_y * at.total;
  const int last = static_cast<int>(y_.size()) - 1;
  int low = 0;
  for (int step = largest_step_; step > 0; step /= 2) {
    const int next = std::min(low + step, last - 1);
    low = Cumulated(at, next) <= wanted ? next : low;
  }
  const Real before = Cumulated(at, low), after = Cumulated(at, low + 1);
  // The two rows of values around it, and then the one between them.
  std::array<Real, kMaxS> first{}, second{};
  for (int n = 0; n < at.count; ++n) {
    const float *row = Row(at.node[n], low), *next = row + num_s_;
    for (int k = 0; k < num_s_; ++k) {
      first[k] += at.weight[n] * static_cast<Real>(row[k]);
      second[k] += at.weight[n] * static_cast<Real>(next[k]);
    }
  }
  const Real mass = after - before;
  const Real part = mass > 0 ? std::clamp((wanted - before) / mass, Real{0}, Real{1}) : Real{0.5};
  const Real from = OfRow(at, low), to = OfRow(at, low + 1);
  const Real t = InvertLinearIntegral(part * (from + to) / 2, from, to);
  for (int k = 0; k < num_s_; ++k) first[k] += t * (second[k] - first[k]);
  Real left = (first[0] + first[num_s_ - 1]) / -2;
  for (int k = 0; k < num_s_; ++k) left += first[k];
  left *= u_s;
  int k = 0;
  for (; k < num_s_ - 2; ++k) {
    const Real cell = (first[k] + first[k + 1]) / 2;
    if (left < cell) break;
    left -= cell;
  }
  const Real f = InvertLinearIntegral(std::max(left, Real{0}), first[k], first[k + 1]);
  return {std::min(y_[low] + t * (y_[low + 1] - y_[low]), at.end),
          (static_cast<Real>(k) + f) / static_cast<Real>(num_s_ - 1),
          first[k] + f * (first[k + 1] - first[k])};
}

template class HalfVectorTable<double>;
template class HalfVectorTable<float>;

}  // namespace trilobe
