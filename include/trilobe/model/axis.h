#ifndef TRILOBE_MODEL_AXIS_H_
#define TRILOBE_MODEL_AXIS_H_

#include <vector>

#include "trilobe/core/math/stencil.h"

namespace trilobe {

// Where the entries of a table stand, and so how a direction (theta, phi) reads it: D is read at
// the half vector, F at (theta_d, 0), G at wi and at wo.
struct Axis {
  enum class Rule {
    kRootTheta,  // bins of equal width in sqrt(theta), linear between their centres
    kTheta,      // bins of equal width in theta, linear between their centres
    kSpline,     // nodes (k + 1/2) 90/size degrees, a Catmull-Rom spline between them
    kPolar,      // nodes (theta_a, phi_b), entry a * phi_nodes + b, bilinear between them
  };
  Rule rule = Rule::kTheta;
  int size = 90;  // entries of a table
  // Of kPolar: theta_a, ascending from 0 or more to below 90 degrees, and how many
  // phi_b = 360 b / phi_nodes degrees there are.
  std::vector<double> theta = {};  // [degrees]
  int phi_nodes = 1;

  // These throw Error for fewer than one of theta or phi, or more than kMaxTableSize of either.
  static Axis Polar(std::vector<double> theta_degrees, int phi_nodes);
  // theta_a at so many even steps from 0 to 75 degrees, the last of UTIA's; or at steps of
  // sqrt(theta), which are denser where highlights are.
  enum class Steps { kOfTheta, kOfRoot };
  static Axis EvenPolar(int thetas, Steps steps, int phi_nodes);
  // The nodes 0, 15, ... 75 degrees by 0, 7.5, ... 352.5 of UTIA's directions (docs/model.md).
  static Axis Utia();

  // How many nodes of kSpline suit data at so few even theta: about three for two theta, as nodes
  // that stand between these would go where they like. And one at 75 degrees, where such data end,
  // so that none beyond is read by little.
  static int SplineNodesFor(int data_thetas);

  bool polar() const { return rule == Rule::kPolar; }
  // A polar axis that ends at 75 degrees, with two more rings, at 84 and 89.9; whether its last is
  // there; and the axis without these two.
  Axis ToHorizon() const;
  bool reaches_horizon() const;
  Axis WithoutHorizon() const;

  // The entries that a direction reads, with their weights; angles in radians. Constant beyond the
  // first and the last, periodic in phi, which the others but kPolar do not look at. What is within
  // 1e-9 of a node, in steps from it to the next, stands at it. Throws Error for angles that are no
  // numbers, and for an axis that CheckAxis would not take for one.
  Stencil At(double theta_radians, double phi_radians) const;

  // Where an entry stands. [rad] These, too, throw Error where there is none.
  double Theta(int entry) const;
  double Phi(int entry) const;  // 0 but for kPolar

  // Of kRootTheta the bin of an entry, a ring. Of kPolar the cell of directions around it: from
  // halfway to the node before it to halfway to the one after it, the outermost as wide outwards as
  // inwards, within [0, 90 degrees]. [rad]
  struct Cell {
    double theta_begin, theta_end, phi_width;
    double SolidAngle() const;
  };
  Cell CellOf(int entry) const;

  bool operator==(const Axis&) const = default;
};

inline constexpr int kMaxTableSize = 2048;
inline constexpr int kMaxBins = 1024;  // of all but kPolar

// Throws Error, which names the factor `name`, unless there are 4 to kMaxTableSize or kMaxBins
// entries, and the nodes are as said above.
void CheckAxis(const Axis& axis, const char* name);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_AXIS_H_
