#ifndef TRILOBE_CORE_BASE_CATMULL_ROM_H_
#define TRILOBE_CORE_BASE_CATMULL_ROM_H_

#include <array>
#include <span>
#include <vector>

#include "trilobe/core/base/stencil.h"

namespace trilobe {

// Catmull-Rom spline through values at theta_k = (k + 1/2) * 90/nodes degrees, k = 0..nodes-1.
// Slopes at the two end nodes are one-sided, and values beyond them constant
// (Pharr, Jakob, Humphreys, Physically Based Rendering, 3rd ed., 8.6.1; docs/model.md).
class CatmullRom {
 public:
  // A point on the spline: at fraction `t` in [0, 1] from node `interval` to the next node.
  struct Location {
    int interval = 0;  // 0..nodes-2
    double t = 0;
  };

  // Needs at least 4 nodes.
  explicit CatmullRom(int nodes);

  int nodes() const { return nodes_; }
  double NodeAngle(int k) const;        // [rad]
  Location Locate(double theta) const;  // throws Error if theta is NaN

  // Weights at t of nodes interval-1 .. interval+2; nodes outside the spline have weight 0.
  std::array<double, 4> Weights(const Location& at) const;

  // The same weights as a stencil over existing nodes.
  Stencil StencilAt(const Location& at) const;
  Stencil StencilAt(double theta) const { return StencilAt(Locate(theta)); }

  // The four weights as polynomials, weight[a] = sum_k c[a][k] t^k (1 - t)^(3 - k): the Bernstein
  // basis without its binomials. Unlike powers of t, it keeps relative precision near an end where
  // a weight vanishes.
  using Cubic = std::array<double, 4>;
  std::array<Cubic, 4> WeightPolynomials(int interval) const;

  // One interval of a spline: a straight line plus a bend,
  //   (1 - t) f0 + t f1 + t (1 - t) ((1 - t) a0 + t a1).
  // This form keeps relative precision near an end with a small value.
  struct Piece {
    double f0 = 0, f1 = 0;  // values at the ends
    double a0 = 0, a1 = 0;  // minus half the second difference; 0 at the ends of the spline

    // `v` is t - 1/2.
    double operator()(double v) const {
      const double t = 0.5 + v, u = 0.5 - v;
      return u * f0 + t * f1 + t * u * (u * a0 + t * a1);
    }
  };

  // The pieces of the spline through `values` [nodes]. [nodes - 1]
  // Throws Error if the number of values differs.
  std::vector<Piece> Pieces(std::span<const double> values) const;

 private:
  int nodes_;
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_BASE_CATMULL_ROM_H_
