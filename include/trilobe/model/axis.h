#ifndef TRILOBE_MODEL_AXIS_H_
#define TRILOBE_MODEL_AXIS_H_

#include <vector>

#include "trilobe/core/base/stencil.h"

namespace trilobe {

// The positions of a table's entries, and how a direction (theta, phi) is interpolated between
// them. D is evaluated at the half vector, F at (theta_d, 0), G at wi and at wo.
struct Axis {
  enum class Rule {
    kRootTheta,  // bins of equal width in sqrt(theta), linear between their centres
    kTheta,      // bins of equal width in theta, linear between their centres
    kSpline,     // nodes (k + 1/2) 90/size degrees, a Catmull-Rom spline between them
    kPolar,      // nodes (theta_a, phi_b), entry a * phi_nodes + b, bilinear between them
  };
  Rule rule = Rule::kTheta;
  int size = 90;  // entries of a table
  // For kPolar: theta_a, ascending in [0, 90) degrees, and the number of azimuths phi_b = 360 b /
  // phi_nodes degrees.
  std::vector<double> theta = {};  // [degrees]
  int phi_nodes = 1;

  // These throw Error unless the numbers of theta and of phi are in [1, kMaxTableSize].
  static Axis Polar(std::vector<double> theta_degrees, int phi_nodes);
  // theta_a in even steps from 0 to 75 degrees, the last theta of UTIA, or in even steps of
  // sqrt(theta), which are denser in highlights.
  enum class Steps { kOfTheta, kOfRoot };
  static Axis EvenPolar(int thetas, Steps steps, int phi_nodes);
  // The nodes of the UTIA database: theta 0, 15, ... 75 by phi 0, 7.5, ... 352.5 degrees
  // (docs/model.md).
  static Axis Utia();

  // Number of kSpline nodes for data on `data_thetas` even theta: about three for two theta, as
  // nodes between measured theta would be poorly determined. One node is at 75 degrees, where such
  // data end, so that no node beyond is read with a small weight.
  static int SplineNodesFor(int data_thetas);

  bool polar() const { return rule == Rule::kPolar; }
  // For polar axes. ToHorizon appends rings at 84 and 89.9 degrees to an axis that ends at 75,
  // reaches_horizon tells whether these are present, and WithoutHorizon removes them.
  Axis ToHorizon() const;
  bool reaches_horizon() const;
  Axis WithoutHorizon() const;

  // The stencil of a direction [rad]: constant beyond the first and last entry, periodic in phi,
  // which only kPolar uses. A direction within 1e-9 node steps of a node reads that node alone.
  // Throws Error for NaN and infinite angles and for an invalid axis (CheckAxis).
  Stencil At(double theta_radians, double phi_radians) const;

  // The angles of an entry [rad]. These also throw Error if there is no such entry.
  double Theta(int entry) const;
  double Phi(int entry) const;  // 0 unless kPolar

  // The cell of an entry [rad]. For kPolar, the directions up to halfway to the neighbouring nodes;
  // outermost cells are symmetric in theta about their node, clipped to [0, 90 degrees]. Otherwise,
  // the ring of its bin, or up to halfway to the neighbouring nodes.
  struct Cell {
    double theta_begin, theta_end, phi_width;
    double SolidAngle() const;
  };
  Cell CellOf(int entry) const;

  bool operator==(const Axis&) const = default;
};

inline constexpr int kMaxTableSize = 2048;
inline constexpr int kMaxBins = 1024;  // of all rules except kPolar

// Throws Error, naming the factor, unless the axis has 4 to kMaxTableSize (kPolar) or kMaxBins
// entries and its nodes are as described above.
void CheckAxis(const Axis& axis, const char* name);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_AXIS_H_
