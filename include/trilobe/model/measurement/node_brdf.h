#ifndef TRILOBE_MODEL_MEASUREMENT_NODE_BRDF_H_
#define TRILOBE_MODEL_MEASUREMENT_NODE_BRDF_H_

#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// Directions at equal steps: node phis * a + b has theta = 90 a / thetas and phi = 360 b / phis
// degrees. The horizon is not a node, and the normal is one for each phi. The default is the grid
// of the UTIA BRDF database: 15 and 7.5 degrees (Filip and Vavra 2014).
struct HemisphereGrid {
  int thetas = 6;
  int phis = 48;

  constexpr int nodes() const { return thetas * phis; }
  double ThetaStep() const { return kPi / 2 / thetas; }
  double PhiStep() const { return 2 * kPi / phis; }
  // These throw Error if there is no such node.
  double Theta(int node) const { return ThetaAt(node, 0); }
  double Phi(int node) const { return PhiAt(node, 0); }
  // The angles of nodes i and o, all four increased by `steps` grid steps.
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

// Throws Error unless the grid has nodes, and at most ten million pairs of them.
void CheckHemisphereGrid(const HemisphereGrid& grid);

// Values at pairs of nodes of a grid.
struct NodeTable {
  std::string source;
  HemisphereGrid grid;
  std::vector<Rgb> rho;        // [nodes()][nodes()], incidence first [1/sr]
  std::vector<bool> present;   // [nodes()][nodes()], whether there is a value
  double max_theta = kPi / 2;  // [rad] of present values
};

// A measurement at nodes as a function of directions: linear in theta_i, phi_i, theta_o and phi_o,
// periodic in phi, constant beyond the last theta. A missing value is that of the nearest pair that
// has one, in grid steps.
class NodeBrdf {
 public:
  // Throws Error unless there is a value, and array sizes match the grid.
  explicit NodeBrdf(NodeTable table);

  const NodeTable& table() const { return table_; }
  // Values of all pairs, with missing ones filled. [nodes()][nodes()]
  const std::vector<Rgb>& values() const { return filled_; }

  // BRDF [1/sr] of two directions above the surface.
  Rgb operator()(const SphericalAngles& at) const;

  // Whether these directions are measured: no theta is beyond max_theta, and the nearest pair of
  // nodes has a value.
  bool Measured(const SphericalAngles& at) const;

  // Whether all 16 pairs around the directions half a step beyond nodes i and o have values.
  bool MeasuredAround(int i, int o) const;

 private:
  NodeTable table_;
  std::vector<Rgb> filled_;  // [nodes()][nodes()]
};

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_NODE_BRDF_H_
