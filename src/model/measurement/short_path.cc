#include "model/measurement/short_path.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Where the axes stand, each by what its movement takes.
using Stand = std::array<double, 3>;

Stand StandOf(const SphericalAngles& at, const AxisCosts& costs) {
  const double phi = std::abs(std::remainder(at.phi_o - at.phi_i, 2 * kPi));
  const bool beyond = costs.in_plane && phi > kPi / 2;
  return {costs.of_radian[0] * at.theta_i, costs.of_radian[1] * (beyond ? -at.theta_o : at.theta_o),
          costs.in_plane ? 0 : costs.of_radian[2] * phi};
}

std::vector<Stand> StandsOf(const std::vector<SphericalAngles>& directions,
                            const AxisCosts& costs) {
  std::vector<Stand> stands;
  for (const SphericalAngles& at : directions) stands.push_back(StandOf(at, costs));
  return stands;
}

double Between(const Stand& a, const Stand& b) {
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
}

using Order = std::vector<size_t>;

Order AsGiven(size_t size) {
  Order order(size);
  std::iota(order.begin(), order.end(), size_t{0});
  return order;
}

double CostOf(const std::vector<Stand>& at, const Order& order) {
  double cost = 0;
  for (size_t k = 1; k < order.size(); ++k) cost += Between(at[order[k - 1]], at[order[k]]);
  return cost;
}

void GoToNearest(const std::vector<Stand>& at, Order* order) {
  for (size_t k = 1; k < order->size(); ++k) {
    const Stand& here = at[(*order)[k - 1]];
    const auto nearest =
        std::ranges::min_element(order->begin() + static_cast<std::ptrdiff_t>(k), order->end(), {},
                                 [&](size_t next) { return Between(here, at[next]); });
    std::swap((*order)[k], *nearest);
  }
}

// Turns parts of the way round while that makes it shorter.
void TurnParts(const std::vector<Stand>& at, Order* order) {
  constexpr int kMostPasses = 100;
  constexpr double kRounding = 1e-12;
  const auto stand = [&](size_t k) -> const Stand& { return at[(*order)[k]]; };
  bool shorter = true;
  for (int pass = 0; shorter && pass < kMostPasses; ++pass) {
    shorter = false;
    for (size_t first = 1; first + 1 < order->size(); ++first) {
      for (size_t last = first + 1; last < order->size(); ++last) {
        double gain =
            Between(stand(first - 1), stand(first)) - Between(stand(first - 1), stand(last));
        if (last + 1 < order->size()) {
          gain += Between(stand(last), stand(last + 1)) - Between(stand(first), stand(last + 1));
        }
        if (!(gain > kRounding)) continue;
        std::reverse(order->begin() + static_cast<std::ptrdiff_t>(first),
                     order->begin() + static_cast<std::ptrdiff_t>(last) + 1);
        shorter = true;
      }
    }
  }
}

}  // namespace

void CheckAxisCosts(const AxisCosts& costs) {
  for (const double cost : costs.of_radian) {
    if (cost >= 0 && cost <= std::numeric_limits<float>::max()) continue;
    throw Error(ErrorKind::kRange, "what an axis takes must be 0 or more").About("path", cost);
  }
}

double PathCost(const std::vector<SphericalAngles>& directions, const AxisCosts& costs) {
  return CostOf(StandsOf(directions, costs), AsGiven(directions.size()));
}

std::vector<SphericalAngles> AlongShortPath(std::vector<SphericalAngles> directions,
                                            const AxisCosts& costs) {
  if (std::ssize(directions) > kMostOfPath) {
    throw Error(ErrorKind::kRange, "a short path through " + std::to_string(directions.size()) +
                                       " directions; it is found for " +
                                       std::to_string(kMostOfPath) + " at most")
        .About("path", directions.size());
  }
  CheckAxisCosts(costs);
  const std::vector<Stand> at = StandsOf(directions, costs);
  const Order given = AsGiven(directions.size());
  Order order = given;
  GoToNearest(at, &order);
  TurnParts(at, &order);
  if (!(CostOf(at, order) < CostOf(at, given))) return directions;
  std::vector<SphericalAngles> ordered;
  for (const size_t k : order) ordered.push_back(directions[k]);
  return ordered;
}

}  // namespace trilobe
