#ifndef TRILOBE_CORE_MATH_CATMULL_ROM_H_
#define TRILOBE_CORE_MATH_CATMULL_ROM_H_

#include <array>
#include <span>
#include <vector>

#include "trilobe/core/math/stencil.h"

namespace trilobe {

// Catmull-Rom spline through values at theta_k = (k + 1/2) * 90/nodes degrees, k = 0..nodes-1, with
// one-sided slopes at the two ends and constant beyond the end nodes
// (Pharr, Jakob, Humphreys, Physically Based Rendering, 3rd ed., 8.6.1; docs/model.md).
class CatmullRom {
 public:
  // A place on the spline: between node `interval` and the next, `t` in [0, 1] of the way.
  struct Location {
    int interval = 0;  // 0..nodes-2
    double t = 0;
  };

  // Needs at least 4 nodes.
  explicit CatmullRom(int nodes);

  int nodes() const { return nodes_; }
  double NodeAngle(int k) const;        // [rad]
  Location Locate(double theta) const;  // throws Error where theta is not a number

  // Weights of the nodes interval-1 .. interval+2 at t; those of nodes that do not exist are 0.
  std::array<double, 4> Weights(const Location& at) const;

  // The same as a stencil over existing nodes.
  Stencil StencilAt(const Location& at) const;
  Stencil StencilAt(double theta) const { return StencilAt(Locate(theta)); }

  // The four weights as polynomials: weight[a] = sum_k c[a][k] t^k (1 - t)^(3 - k), the Bernstein
  // basis but for its binomials. A weight that vanishes at an end of the interval has no terms
  // that do not, so near there it keeps its digits, as powers of t alone would not.
  using Cubic = std::array<double, 4>;
  std::array<Cubic, 4> WeightPolynomials(int interval) const;

  // One interval of a spline: a straight line and what bends it,
  //   (1 - t) f0 + t f1 + t (1 - t) ((1 - t) a0 + t a1),
  // which is as exact near a small value at one end as at that end itself.
  struct Piece {
    double f0 = 0, f1 = 0;  // values at the ends
    double a0 = 0, a1 = 0;  // minus half the second difference there, 0 at the spline's own ends

    // `v` is t - 1/2.
    double operator()(double v) const {
      const double t = 0.5 + v, u = 0.5 - v;
      return u * f0 + t * f1 + t * u * (u * a0 + t * a1);
    }
  };

  // The spline through `values` [nodes], interval by interval. [nodes - 1]
  // Throws Error for another number of values.
  std::vector<Piece> Pieces(std::span<const double> values) const;

 private:
  int nodes_;
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_MATH_CATMULL_ROM_H_
