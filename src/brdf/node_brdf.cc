#include "trilobe/brdf/node_brdf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

#include "trilobe/base/error.h"

namespace trilobe {
namespace {

constexpr double kRounding = 1e-9;  // [rad], of degrees that became radians

// Two neighbouring values of an angle, and the share of the upper one.
struct Between {
  int lower, upper;
  double t;
};

Between BetweenThetas(const NodeTable& table, double theta) {
  const double place =
      std::clamp(theta / table.ThetaStep(), 0.0, static_cast<double>(table.thetas - 1));
  const int a = static_cast<int>(place);
  return {a, std::min(a + 1, table.thetas - 1), place - a};
}

Between BetweenPhis(const NodeTable& table, double phi) {
  const double turns = phi / (2 * kPi);
  const double place = (turns - std::floor(turns)) * table.phis;
  const int whole = static_cast<int>(place);
  const int b = whole % table.phis;
  return {b, (b + 1) % table.phis, place - whole};
}

// The four nodes between which a direction lies, with their weights.
struct Corners {
  std::array<int, 4> node;
  std::array<double, 4> weight;
};

Corners CornersOf(const NodeTable& table, double theta, double phi) {
  const Between a = BetweenThetas(table, theta), b = BetweenPhis(table, phi);
  const int lower = a.lower * table.phis, upper = a.upper * table.phis;
  return {{lower + b.lower, lower + b.upper, upper + b.lower, upper + b.upper},
          {(1 - a.t) * (1 - b.t), (1 - a.t) * b.t, a.t * (1 - b.t), a.t * b.t}};
}

int NearestNode(const NodeTable& table, double theta, double phi) {
  const Between a = BetweenThetas(table, theta), b = BetweenPhis(table, phi);
  return (a.t < 0.5 ? a.lower : a.upper) * table.phis + (b.t < 0.5 ? b.lower : b.upper);
}

size_t IndexOf(const NodeTable& table, int i, int o) {
  return static_cast<size_t>(i) * table.nodes() + o;
}

// Breadth first from all pairs with a value at once: each hands its own on to its neighbours.
std::vector<Rgb> Filled(const NodeTable& table) {
  std::vector<Rgb> rho = table.rho;
  std::vector<bool> known = table.present;
  std::vector<size_t> reached;
  for (size_t k = 0; k < known.size(); ++k) {
    if (known[k]) reached.push_back(k);
  }
  if (reached.size() == known.size()) return rho;
  const auto neighbours = [&](int node) {
    const int a = node / table.phis, b = node % table.phis;
    return std::array{
        std::max(a - 1, 0) * table.phis + b, std::min(a + 1, table.thetas - 1) * table.phis + b,
        a * table.phis + (b + table.phis - 1) % table.phis, a * table.phis + (b + 1) % table.phis};
  };
  for (size_t next = 0; next < reached.size(); ++next) {
    const size_t from = reached[next];
    const int i = static_cast<int>(from / table.nodes());
    const int o = static_cast<int>(from % table.nodes());
    const auto hand_on = [&](size_t to) {
      if (known[to]) return;
      known[to] = true;
      rho[to] = rho[from];
      reached.push_back(to);
    };
    for (const int other : neighbours(i)) hand_on(IndexOf(table, other, o));
    for (const int other : neighbours(o)) hand_on(IndexOf(table, i, other));
  }
  return rho;
}

}  // namespace

NodeBrdf::NodeBrdf(NodeTable table) : table_(std::move(table)) {
  const auto nodes = static_cast<size_t>(std::max(table_.nodes(), 0));
  if (table_.thetas < 1 || table_.phis < 1 || table_.rho.size() != nodes * nodes ||
      table_.present.size() != nodes * nodes) {
    throw Error(table_.source + ": a table of nodes needs a value for each pair of its " +
                std::to_string(nodes) + " nodes");
  }
  if (std::ranges::none_of(table_.present, [](bool present) { return present; })) {
    throw Error(table_.source + ": no pair of nodes has a value");
  }
  filled_ = Filled(table_);
}

Rgb NodeBrdf::operator()(const SphericalAngles& at) const {
  const Corners i = CornersOf(table_, at.theta_i, at.phi_i);
  const Corners o = CornersOf(table_, at.theta_o, at.phi_o);
  Rgb rho{};
  for (int k = 0; k < 4; ++k) {
    const Rgb* const row = &filled_[IndexOf(table_, i.node[k], 0)];
    for (int l = 0; l < 4; ++l) {
      const double weight = i.weight[k] * o.weight[l];
      for (int c = 0; c < kChannels; ++c) rho[c] += weight * row[o.node[l]][c];
    }
  }
  return rho;
}

bool NodeBrdf::Measured(const SphericalAngles& at) const {
  return std::max(at.theta_i, at.theta_o) <= table_.max_theta + kRounding &&
         table_.present[IndexOf(table_, NearestNode(table_, at.theta_i, at.phi_i),
                                NearestNode(table_, at.theta_o, at.phi_o))];
}

bool NodeBrdf::MeasuredAround(int i, int o) const {
  if (std::max(i, o) / table_.phis == table_.thetas - 1) return false;
  const SphericalAngles at = table_.Angles(i, o, 0.5);
  const Corners around_i = CornersOf(table_, at.theta_i, at.phi_i);
  const Corners around_o = CornersOf(table_, at.theta_o, at.phi_o);
  return std::ranges::all_of(around_i.node, [&](int k) {
    return std::ranges::all_of(around_o.node,
                               [&](int l) { return table_.present[IndexOf(table_, k, l)]; });
  });
}

}  // namespace trilobe
