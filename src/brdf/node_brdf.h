#ifndef TRILOBE_BRDF_NODE_BRDF_H_
#define TRILOBE_BRDF_NODE_BRDF_H_

#include <string>
#include <vector>

#include "trilobe/brdf/channels.h"
#include "trilobe/brdf/directions.h"

namespace trilobe {

// Values at all pairs of nodes of a hemisphere: node phis * a + b has theta = 90 a / thetas and
// phi = 360 b / phis degrees.
struct NodeTable {
  std::string source;
  int thetas = 0, phis = 0;
  std::vector<Rgb> rho;        // [nodes()][nodes()], incidence first [1/sr]
  std::vector<bool> present;   // [nodes()][nodes()], where there is a value
  double max_theta = kPi / 2;  // [rad] of what is present

  int nodes() const { return thetas * phis; }
  double ThetaStep() const { return kPi / 2 / thetas; }
  double PhiStep() const { return 2 * kPi / phis; }
  // Of nodes i and o, moved by so many steps in all four angles.
  SphericalAngles Angles(int i, int o, double steps = 0) const {
    const int a_i = i / phis, b_i = i % phis, a_o = o / phis, b_o = o % phis;
    return {(a_i + steps) * ThetaStep(), (b_i + steps) * PhiStep(), (a_o + steps) * ThetaStep(),
            (b_o + steps) * PhiStep()};
  }
};

// A measurement at nodes as a function of directions: linear in theta_i, phi_i, theta_o and phi_o
// between nodes, periodic in phi, constant beyond the last theta. A node without a value takes that
// of the nearest one that has one, by the number of steps from node to node.
class NodeBrdf {
 public:
  // Throws Error unless there is a value, and as many as there are pairs.
  explicit NodeBrdf(NodeTable table);

  const NodeTable& table() const { return table_; }

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

#endif  // TRILOBE_BRDF_NODE_BRDF_H_
