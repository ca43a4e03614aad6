#include "trilobe/model/measurement/node_brdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "trilobe/core/base/error.h"
#include "trilobe/core/base/stencil.h"

namespace trilobe {
namespace {

constexpr double kRadianRounding = 1e-9;  // [rad], of degrees that became radians

Between BetweenThetas(const HemisphereGrid& grid, double theta) {
  if (std::isnan(theta)) {
    throw Error(ErrorKind::kRange, "a direction or an angle is not a number").About("theta", theta);
  }
  const double place =
      std::clamp(theta / grid.ThetaStep(), 0.0, static_cast<double>(grid.thetas - 1));
  const int a = static_cast<int>(place);
  return {a, std::min(a + 1, grid.thetas - 1), place - a};
}

// The four nodes around a direction, with weights.
struct Corners {
  std::array<int, 4> node;
  std::array<double, 4> weight;
};

Corners CornersOf(const HemisphereGrid& grid, double theta, double phi) {
  const Between a = BetweenThetas(grid, theta), b = OnCircle(phi, grid.phis);
  const int lower = a.lower * grid.phis, upper = a.upper * grid.phis;
  return {{lower + b.lower, lower + b.upper, upper + b.lower, upper + b.upper},
          {(1 - a.t) * (1 - b.t), (1 - a.t) * b.t, a.t * (1 - b.t), a.t * b.t}};
}

int NearestNode(const HemisphereGrid& grid, double theta, double phi) {
  const Between a = BetweenThetas(grid, theta), b = OnCircle(phi, grid.phis);
  return (a.t < 0.5 ? a.lower : a.upper) * grid.phis + (b.t < 0.5 ? b.lower : b.upper);
}

size_t IndexOf(const HemisphereGrid& grid, int i, int o) {
  return static_cast<size_t>(i) * grid.nodes() + o;
}

// Breadth first from all pairs with a value: each passes its value on to its neighbours.
std::vector<Rgb> Filled(const NodeTable& table) {
  const HemisphereGrid& grid = table.grid;
  std::vector<Rgb> rho = table.rho;
  std::vector<bool> known = table.present;
  std::vector<size_t> reached;
  for (size_t k = 0; k < known.size(); ++k) {
    if (known[k]) reached.push_back(k);
  }
  if (reached.size() == known.size()) return rho;
  const auto neighbours = [&](int node) {
    const int a = node / grid.phis, b = node % grid.phis;
    return std::array{
        std::max(a - 1, 0) * grid.phis + b, std::min(a + 1, grid.thetas - 1) * grid.phis + b,
        a * grid.phis + (b + grid.phis - 1) % grid.phis, a * grid.phis + (b + 1) % grid.phis};
  };
  for (size_t next = 0; next < reached.size(); ++next) {
    const size_t from = reached[next];
    const int i = static_cast<int>(from / grid.nodes());
    const int o = static_cast<int>(from % grid.nodes());
    const auto hand_on = [&](size_t target) {
      if (known[target]) return;
      known[target] = true;
      rho[target] = rho[from];
      reached.push_back(target);
    };
    for (const int other : neighbours(i)) hand_on(IndexOf(grid, other, o));
    for (const int other : neighbours(o)) hand_on(IndexOf(grid, i, other));
  }
  return rho;
}

}  // namespace

void CheckHemisphereGrid(const HemisphereGrid& grid) {
  constexpr double kMostPairs = 1e7;
  const double nodes = 1.0 * grid.thetas * grid.phis;
  if (grid.thetas >= 1 && grid.phis >= 1 && nodes * nodes <= kMostPairs) return;
  throw Error(ErrorKind::kRange,
              "a grid of " + std::to_string(grid.thetas) + " theta by " +
                  std::to_string(grid.phis) +
                  " phi; it needs at least one of each, and at most 3162 directions")
      .About("grid of directions");
}

std::optional<int> HemisphereGrid::Find(double theta, double phi) const {
  constexpr double kSame = 1e-6;  // [rad]
  const double theta_step = ThetaStep(), phi_step = PhiStep();
  const double a = std::round(theta / theta_step);
  const double turned = phi - 2 * kPi * std::floor(phi / (2 * kPi));
  const double b = std::round(turned / phi_step);
  if (!(a >= 0 && a < thetas && std::abs(theta - a * theta_step) <= kSame &&
        std::abs(turned - b * phi_step) <= kSame)) {
    return std::nullopt;
  }
  return static_cast<int>(a) * phis + static_cast<int>(b) % phis;
}

NodeBrdf::NodeBrdf(NodeTable table) : table_(std::move(table)) {
  CheckHemisphereGrid(table_.grid);
  const auto nodes = static_cast<size_t>(table_.grid.nodes());
  if (table_.rho.size() != nodes * nodes || table_.present.size() != nodes * nodes) {
    throw ErrorIn(
        ErrorKind::kMismatch, table_.source,
        "a table of nodes needs a value for each pair of its " + std::to_string(nodes) + " nodes")
        .About("rho", table_.rho.size());
  }
  if (std::ranges::none_of(table_.present, [](bool present) { return present; })) {
    throw ErrorIn(ErrorKind::kData, table_.source, "no pair of nodes has a value").About("present");
  }
  filled_ = Filled(table_);
}

Rgb NodeBrdf::operator()(const SphericalAngles& at) const {
  const Corners i = CornersOf(table_.grid, at.theta_i, at.phi_i);
  const Corners o = CornersOf(table_.grid, at.theta_o, at.phi_o);
  Rgb rho{};
  for (int k = 0; k < 4; ++k) {
    const Rgb* const row = &filled_[IndexOf(table_.grid, i.node[k], 0)];
    for (int l = 0; l < 4; ++l) {
      const double weight = i.weight[k] * o.weight[l];
      for (int c = 0; c < kChannels; ++c) rho[c] += weight * row[o.node[l]][c];
    }
  }
  return rho;
}

bool NodeBrdf::Measured(const SphericalAngles& at) const {
  return std::max(at.theta_i, at.theta_o) <= table_.max_theta + kRadianRounding &&
         table_.present[IndexOf(table_.grid, NearestNode(table_.grid, at.theta_i, at.phi_i),
                                NearestNode(table_.grid, at.theta_o, at.phi_o))];
}

bool NodeBrdf::MeasuredAround(int i, int o) const {
  for (const int node : {i, o}) CheckIndex(node, table_.grid.nodes(), "the node");
  if (std::max(i, o) / table_.grid.phis == table_.grid.thetas - 1) return false;
  const SphericalAngles at = table_.grid.Angles(i, o, 0.5);
  const Corners around_i = CornersOf(table_.grid, at.theta_i, at.phi_i);
  const Corners around_o = CornersOf(table_.grid, at.theta_o, at.phi_o);
  return std::ranges::all_of(around_i.node, [&](int k) {
    return std::ranges::all_of(around_o.node,
                               [&](int l) { return table_.present[IndexOf(table_.grid, k, l)]; });
  });
}

}  // namespace trilobe
