#ifndef TRILOBE_IO_FORMATS_DATABASES_BILINEAR_WARP_H_
#define TRILOBE_IO_FORMATS_DATABASES_BILINEAR_WARP_H_

#include <array>
#include <cstddef>
#include <vector>

namespace trilobe {

// A point of the unit square: x runs along the columns of a table, y along its rows.
struct SquarePoint {
  double x = 0;
  double y = 0;
};

// A point between `index` and `index + 1` of equally spaced nodes, `fraction` of the way.
struct NodeInterval {
  int index = 0;  // 0 .. nodes-2
  double fraction = 0;
};

// The interval of x in [0, 1] among `nodes` >= 2 equally spaced nodes from 0 to 1. Other x are
// clamped; NaN becomes 0.
NodeInterval LocateNode(double x, int nodes);

// Weights of a (bi)linear blend of up to four slices of a stack of tables; they add up to 1.
struct SliceBlend {
  int count = 0;
  std::array<int, 4> slice{};
  std::array<double, 4> weight{};

  void Add(int index, double w) {
    slice[count] = index;
    weight[count++] = w;
  }
};

// Functions on the unit square: a stack of tables of node values, interpolated bilinearly.
struct BilinearStack {
  int rows = 0;                // >= 2
  int columns = 0;             // >= 2
  std::vector<double> values;  // [slices][rows][columns]

  int slices() const { return static_cast<int>(values.size()) / (rows * columns); }
  // The value of one slice at a point.
  double At(int slice, const SquarePoint& point) const;
  // The slices `of_each` of every `all` successive ones, in this order.
  BilinearStack Chosen(int all, const std::vector<size_t>& of_each) const;
};

// Maps a blend of piecewise bilinear densities on the unit square to uniform coordinates (Dupuy and
// Jakob, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering", 2018).
// Each slice is normalised to integrate to 1, and so is any blend. The running integrals of a blend
// are blends of the slices' running integrals, which are computed once.
class BilinearWarp {
 public:
  // `density` >= 0. A slice that is zero everywhere has no normalised form; see FirstVanishing.
  explicit BilinearWarp(BilinearStack density);

  // The first slice that is zero everywhere, or -1.
  static int FirstVanishing(const BilinearStack& density);

  // The inverse of sampling: maps a point (u, v) to uniform (x, y) in [0, 1]^2. With density p,
  //   y = int_0^v int_0^1 p(s, t) ds dt,   x = int_0^u p(s, v) ds / int_0^1 p(s, v) ds.
  // On a row where p is 0, x = u.
  SquarePoint Invert(const SliceBlend& blend, const SquarePoint& point) const;

  // Sampling with one slice: the point that Invert maps to `uniform` in [0, 1]^2. If there are
  // several, because the density is 0, returns one of them.
  SquarePoint Sample(int slice, const SquarePoint& uniform) const;

 private:
  BilinearStack density_;
  std::vector<double> row_integral_;  // [slices][rows][columns]: along the row up to each node
  std::vector<double> marginal_;      // [slices][rows]: over all rows up to each
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_DATABASES_BILINEAR_WARP_H_
