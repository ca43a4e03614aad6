#include "fit/greedy_design.h"

#include <Eigen/LU>
#include <algorithm>
#include <cstdint>
#include <utility>

#include "trilobe/core/base/check.h"

namespace trilobe {
namespace {

using OfChannels = Eigen::Matrix<double, kChannels, kChannels>;

}  // namespace

GreedyDesign::GreedyDesign(Eigen::MatrixXd reads, const Eigen::MatrixXd& seen)
    : reads_(std::move(reads)),
      covariances_(reads_),
      with_seen_(reads_ * seen.transpose()),
      variance_(seen.squaredNorm()),
      measured_(reads_.rows() / kChannels) {}

double GreedyDesign::Gain(int candidate) const {
  CheckIndex(candidate, static_cast<int64_t>(measured_.size()), "the candidate");
  const int row = kChannels * candidate;
  const OfChannels told =
      OfChannels::Identity() +
      reads_.middleRows<kChannels>(row) * covariances_.middleRows<kChannels>(row).transpose();
  const OfChannels of_seen =
      with_seen_.middleRows<kChannels>(row) * with_seen_.middleRows<kChannels>(row).transpose();
  return std::max((told.inverse() * of_seen).trace(), 0.0);
}

int GreedyDesign::Best() const {
  int best = -1;
  double largest = -1;
  for (int c = 0; c < std::ssize(measured_); ++c) {
    if (measured_[c]) continue;
    if (const double gain = Gain(c); gain > largest) {
      largest = gain;
      best = c;
    }
  }
  return best;
}

int GreedyDesign::First() const {
  const auto first = std::ranges::find(measured_, false);
  return first == measured_.end() ? -1 : static_cast<int>(first - measured_.begin());
}

void GreedyDesign::Measure(int candidate) {
  CheckIndex(candidate, static_cast<int64_t>(measured_.size()), "the candidate");
  measured_[candidate] = true;
  for (int row = kChannels * candidate; row < kChannels * (candidate + 1); ++row) {
    const Eigen::VectorXd with_all = covariances_.row(row), with_seen = with_seen_.row(row);
    const double told = 1 + reads_.row(row).dot(with_all);
    const Eigen::VectorXd of_reads = reads_ * with_all / told;
    covariances_.noalias() -= of_reads * with_all.transpose();
    with_seen_.noalias() -= of_reads * with_seen.transpose();
    variance_ = std::max(variance_ - with_seen.squaredNorm() / told, 0.0);
  }
}

}  // namespace trilobe
