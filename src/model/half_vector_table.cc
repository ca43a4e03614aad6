#include "trilobe/model/half_vector_table.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#include "core/base/lanes.h"
#include "core/base/linear_density.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Numbers of bins of theta_i, and of fractions of an integral, from which searches start.
constexpr int kThetaBins = 1024, kPartBins = 64;
constexpr double kThetaBin = kPi / 2 / kThetaBins;

// Bins of y of nearly equal width in log y, from the leading bits of a float: 64 per factor of 2
// below 1.
constexpr int kYOctaves = 44, kYBins = 64 * kYOctaves;
int BinOfY(float y) {
  constexpr auto kFirst = static_cast<int32_t>((127 - kYOctaves) << 6);
  return std::clamp((std::bit_cast<int32_t>(y) >> 17) - kFirst, 0, kYBins - 1);
}
float BeginOfYBin(int bin) {
  return std::bit_cast<float>(static_cast<int32_t>(bin + ((127 - kYOctaves) << 6)) << 17);
}

}  // namespace

template <typename Real>
HalfVectorTable<Real>::HalfVectorTable(const Nodes& nodes, const std::vector<float>& values)
    : y_(nodes.y.begin(), nodes.y.end()),
      theta_i_(nodes.theta_i.begin(), nodes.theta_i.end()),
      num_s_(nodes.s),
      num_phi_i_(nodes.phi_i),
      values_(values) {
  const int rows = static_cast<int>(y_.size()), rings = static_cast<int>(theta_i_.size());
  if (num_s_ < 5 || num_s_ > kMaxS || num_s_ % 4 != 1) {
    throw Error(ErrorKind::kRange,
                "a table needs 5 to 129 nodes of s, one more than a multiple of 4")
        .About("s", num_s_);
  }
  int begin = 0;
  for (int bin = 0; bin <= kThetaBins; ++bin) {
    while (begin + 2 < rings && nodes.theta_i[begin + 1] <= kThetaBin * (bin - 0.5)) ++begin;
    theta_guide_.push_back(begin);
  }
  begin = 0;
  for (int bin = 0; bin < kYBins; ++bin) {
    while (begin + 2 < rows && y_[begin + 1] <= static_cast<Real>(BeginOfYBin(bin))) ++begin;
    y_guide_.push_back(begin);
  }
  for (int node = 0; node < rings * num_phi_i_; ++node) {
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
    const Real* const cumulated = &cumulated_[static_cast<size_t>(node) * rows];
    begin = 0;
    for (int bin = 0; bin <= kPartBins; ++bin) {
      const Real part = cumulated[rows - 1] * static_cast<Real>(bin) / kPartBins;
      while (begin + 2 < rows && cumulated[begin + 1] <= part) ++begin;
      row_guide_.push_back(begin);
    }
  }
}

template <typename Real>
typename HalfVectorTable<Real>::Condition HalfVectorTable<Real>::At(Real theta_i, Real phi_i,
                                                                    Real end) const {
  Condition at;
  int ring = theta_guide_[std::clamp(static_cast<int>(theta_i * static_cast<Real>(1 / kThetaBin)),
                                     0, kThetaBins)];
  while (ring + 2 < static_cast<int>(theta_i_.size()) && theta_i_[ring + 1] <= theta_i) ++ring;
  const Real t = std::clamp((theta_i - theta_i_[ring]) / (theta_i_[ring + 1] - theta_i_[ring]),
                            Real{0}, Real{1});
  if (num_phi_i_ == 1) {
    at.count = 2;
    at.node = {ring, ring + 1};
    at.weight = {1 - t, t};
  } else {
    const Real turns = phi_i * static_cast<Real>(0.5 / kPi);
    const Real x = (turns - std::floor(turns)) * static_cast<Real>(num_phi_i_);
    const int low = std::min(static_cast<int>(x), num_phi_i_ - 1);
    const int high = low + 1 < num_phi_i_ ? low + 1 : 0;
    const Real f = x - static_cast<Real>(low);
    const int first = ring * num_phi_i_, second = first + num_phi_i_;
    at.count = 4;
    at.node = {first + low, first + high, second + low, second + high};
    at.weight = {(1 - t) * (1 - f), (1 - t) * f, t * (1 - f), t * f};
  }
  at.end = end;
  const int row = IntervalOfY(end);
  const Real part = end - y_[row], width = y_[row + 1] - y_[row];
  const Real lower = OfRow(at, row), upper = OfRow(at, row + 1);
  at.total = Cumulated(at, row) + part * (lower + (upper - lower) * part / (2 * width));
  return at;
}

template <typename Real>
int HalfVectorTable<Real>::IntervalOfY(Real y) const {
  // Rounding may put y into the next bin.
  int row = y_guide_[BinOfY(static_cast<float>(y))];
  row -= row > 0 && y_[row] > y;
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

// The interval of y where the cumulated integral reaches `wanted`: a branchless search between the
// intervals of the individual nodes.
template <typename Real>
int HalfVectorTable<Real>::RowWith(const Condition& at, Real wanted) const {
  const int last = static_cast<int>(y_.size()) - 2;
  const Real all = Cumulated(at, last + 1);
  const Real part = all > 0 ? wanted / all : Real{0};
  const int bin = std::clamp(static_cast<int>(part * kPartBins), 0, kPartBins - 1);
  int low = last, high = 0;
  for (int n = 0; n < at.count; ++n) {
    const int* const guide = &row_guide_[static_cast<size_t>(at.node[n]) * (kPartBins + 1) + bin];
    low = std::min(low, guide[0]);
    high = std::max(high, guide[1]);
  }
  // A node without light has its fractions at its end, and rounding may lead to the next bin.
  while (low > 0 && Cumulated(at, low) > wanted) --low;
  for (int step = static_cast<int>(std::bit_floor(static_cast<unsigned>(high - low + 1))); step > 0;
       step /= 2) {
    const int next = std::min(low + step, last);
    low = Cumulated(at, next) <= wanted ? next : low;
  }
  return low;
}

template <typename Real>
typename HalfVectorTable<Real>::Sample HalfVectorTable<Real>::Draw(const Condition& at, Real u_y,
                                                                   Real u_s) const {
  const Real wanted = u_y * at.total;
  const int row = RowWith(at, wanted);
  const Real before = Cumulated(at, row), mass = Cumulated(at, row + 1) - before;
  const Real part = mass > 0 ? std::clamp((wanted - before) / mass, Real{0}, Real{1}) : Real{0};
  const Real lower = OfRow(at, row), upper = OfRow(at, row + 1);
  const Real t = InvertLinearIntegral(part * (lower + upper) / 2, lower, upper);
  // The row of values at this y, in floats: precise enough for a draw.
  constexpr int kMost = (kMaxS - 1) / 4;
  float at_s[kMaxS];
  const int groups = (num_s_ - 1) / 4, end_s = num_s_ - 1;
  const auto mix = [&](auto of_count) {
    constexpr int kCount = of_count;
    std::array<const float*, kCount> low;
    std::array<float, kCount> below, above;
    for (int n = 0; n < kCount; ++n) {
      low[n] = Row(at.node[n], row);
      below[n] = static_cast<float>(at.weight[n] * (1 - t));
      above[n] = static_cast<float>(at.weight[n] * t);
    }
    for (int g = 0; g < groups; ++g) {
      Four<float> four{};
      for (int n = 0; n < kCount; ++n) {
        four += below[n] * Load(low[n] + 4 * g) + above[n] * Load(low[n] + num_s_ + 4 * g);
      }
      Store<float>(four, at_s + 4 * g);
    }
    at_s[end_s] = 0;
    for (int n = 0; n < kCount; ++n) {
      at_s[end_s] += below[n] * low[n][end_s] + above[n] * low[n][num_s_ + end_s];
    }
  };
  if (at.count == 2) {
    mix(std::integral_constant<int, 2>());
  } else {
    mix(std::integral_constant<int, 4>());
  }
  // Twice the integral up to each fourth node, and within a group up to each of its four cells.
  float sums[kMost + 1];
  sums[0] = 0;
  for (int g = 0; g < groups; ++g) {
    const float* const a = at_s + 4 * g;
    sums[g + 1] = sums[g] + (a[0] + 2 * (a[1] + a[2] + a[3]) + a[4]);
  }
  auto left = static_cast<float>(u_s) * sums[groups];
  int group = 0;
  for (int g = 1; g < groups; ++g) group += left >= sums[g];
  left -= sums[group];
  const float* const a = at_s + 4 * group;
  const float one = a[0] + a[1], two = one + (a[1] + a[2]), three = two + (a[2] + a[3]);
  const int cell = (left >= one) + (left >= two) + (left >= three);
  left -= cell == 0 ? 0 : cell == 1 ? one : cell == 2 ? two : three;
  const int k = 4 * group + cell;
  const float f = InvertLinearIntegral(std::max(left / 2, 0.0F), at_s[k], at_s[k + 1]);
  // The value with the precision of Value().
  const Real g = static_cast<Real>(f);
  Real value = 0;
  for (int n = 0; n < at.count; ++n) {
    const float *low = Row(at.node[n], row) + k, *high = low + num_s_;
    value += at.weight[n] *
             ((1 - t) * ((1 - g) * low[0] + g * low[1]) + t * ((1 - g) * high[0] + g * high[1]));
  }
  return {std::min(y_[row] + t * (y_[row + 1] - y_[row]), at.end),
          (static_cast<Real>(k) + g) / static_cast<Real>(num_s_ - 1), value};
}

template class HalfVectorTable<double>;
template class HalfVectorTable<float>;

std::vector<double> NodesOfY(const ModelSpec& spec) {
  const Axis& d_axis = spec.d_axis;
  std::vector<double> theta = {0};
  if (d_axis.polar()) {
    constexpr int kSteps = 4;
    std::vector<double> rings = d_axis.theta;
    if (rings.front() > 0) rings.insert(rings.begin(), 0);
    rings.push_back(90);
    for (size_t a = 1; a < rings.size(); ++a) {
      for (int k = 1; k <= kSteps; ++k) {
        const double degrees = rings[a - 1] + (rings[a] - rings[a - 1]) * k / kSteps;
        theta.push_back(DegreesToRadians(degrees));
      }
    }
  } else {
    // Half bins of sqrt(theta), or smaller if a stretch narrows these.
    const int steps = (spec.stretches.any() ? 4 : 2) * d_axis.size;
    for (int k = 1; k <= steps; ++k) {
      const double x = static_cast<double>(k) / steps;
      theta.push_back(x * x * kPi / 2);
    }
  }
  std::vector<double> y;
  for (const double t : theta) y.push_back(std::sin(t) * std::sin(t));
  y.back() = 1;
  return y;
}

}  // namespace trilobe
