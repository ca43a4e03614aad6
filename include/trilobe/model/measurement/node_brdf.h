#ifndef TRILOBE_MODEL_MEASUREMENT_NODE_BRDF_H_
#define TRILOBE_MODEL_MEASUREMENT_NODE_BRDF_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/check.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"

namespace trilobe {

// Directions above a sample at equal steps: node phis * a + b has theta = 90 a / thetas and
// phi = 360 b / phis degrees. So the horizon is no node, and the normal is one for each phi. The
// default is the grid of the UTIA BRDF database: 15 and 7.5 degrees (Filip and Vavra 2014).
struct HemisphereGrid {
  int thetas = 6;
  int phis = 48;

  constexpr int nodes() const { return thetas * phis; }
  double ThetaStep() const { return kPi / 2 / thetas; }
  double PhiStep() const { return 2 * kPi / phis; }
  // These throw Error where there is no such node.
  double Theta(int node) const { return ThetaAt(node, 0); }
  double Phi(int node) const { return PhiAt(node, 0); }
  // Of nodes i and o, moved by so many steps in all four angles.
  SphericalAngles Angles(int i, int o, double steps = 0) const {
    return {ThetaAt(i, steps), PhiAt(i, steps), ThetaAt(o, steps), PhiAt(o, steps)};
  }

  // The node at these angles [rad], to 1e-6; phi is taken modulo 2 pi.
  std::optional<int> Find(double theta, double phi) const;

  bool operator==(const HemisphereGrid&) const = default;

 private:
  double ThetaAt(int node, double steps) const {
    CheckIndex(node, nodes(), "the node");
    const int a = node / phis;
    return (a + steps) * ThetaStep();
  }
  double PhiAt(int node, double steps) const {
    CheckIndex(node, nodes(), "the node");
    return (node % phis + steps) * PhiStep();
  }
};

// Throws Error unless the grid has nodes, and no more than ten million pairs of them.
void CheckHemisphereGrid(const HemisphereGrid& grid);

// Values at all pairs of nodes of a grid.
struct NodeTable {
  std::string source;
  HemisphereGrid grid;
  std::vector<Rgb> rho;        // [nodes()][nodes()], incidence first [1/sr]
  std::vector<bool> present;   // [nodes()][nodes()], where there is a value
  double max_theta = kPi / 2;  // [rad] of what is present
};

// A measurement at nodes as a function of directions: linear in theta_i, phi_i, theta_o and phi_o
// between nodes, periodic in phi, constant beyond the last theta. A node without a value takes that
// of the nearest one that has one, by the number of steps from node to node.
class NodeBrdf {
 public:
  // Throws Error unless there is a value, and as many as there are pairs.
  explicit NodeBrdf(NodeTable table);

  const NodeTable& table() const { return table_; }
  // Of all pairs, whether they had a value or not. [nodes()][nodes()]
  const std::vector<Rgb>& values() const { return filled_; }

  // BRDF [1/sr] of two directions above the surface.
  Rgb operator()(const SphericalAngles& at) const;

  // Whether the measurement speaks about these directions: no theta is beyond max_theta, and the
  // nearest pair of nodes has a value.
  bool Measured(const SphericalAngles& at) const;

  // Whether all 16 pairs have a value between which the directions lie that are half a step beyond
  // nodes i and o.
  bool MeasuredAround(int i, int o) const;

 private:
  NodeTable table_;
  std::vector<Rgb> filled_;  // [nodes()][nodes()]
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_NODE_BRDF_H_
