#ifndef TRILOBE_IO_FORMATS_BILINEAR_WARP_H_
#define TRILOBE_IO_FORMATS_BILINEAR_WARP_H_

#include <array>
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

// Where x in [0, 1] lies between `nodes` >= 2 nodes from 0 to 1. Others go to the nearer end, NaN
// to 0.
NodeInterval LocateNode(double x, int nodes);

// Up to four slices of a stack of tables with the weights of their (bi)linear blend, which add up
// to 1.
struct SliceBlend {
  int count = 0;
  std::array<int, 4> slice{};
  std::array<double, 4> weight{};

  void Add(int index, double w) {
    slice[count] = index;
    weight[count++] = w;
  }
};

// Functions on the unit square: a stack of tables of node values, bilinear between the nodes.
struct BilinearStack {
  int rows = 0;                // >= 2
  int columns = 0;             // >= 2
  std::vector<double> values;  // [slices][rows][columns]

  int slices() const { return static_cast<int>(values.size()) / (rows * columns); }
  // The value of one slice at a point.
  double At(int slice, const SquarePoint& point) const;
};

// A density on the unit square that is a blend of piecewise bilinear ones, as a map to uniform
// coordinates (Dupuy and Jakob, "An Adaptive Parameterization for Efficient Material Acquisition
// and Rendering", 2018). Each slice is normalised to integrate to 1, so that any blend does, and
// blends of the running integrals, which are made once, are the running integrals of the blend.
class BilinearWarp {
 public:
  // `density` >= 0. A slice that is zero everywhere has no normalised form; see FirstVanishing.
  explicit BilinearWarp(BilinearStack density);

  // The first slice that is zero everywhere, or -1.
  static int FirstVanishing(const BilinearStack& density);

  // The inverse of sampling: where the blend sends a point. With p the density,
  //   y = int_0^v int_0^1 p(s, t) ds dt,   x = int_0^u p(s, v) ds / int_0^1 p(s, v) ds.
  // On a row where p vanishes x is undefined, and u itself is taken. In [0, 1]^2.
  SquarePoint Invert(const SliceBlend& blend, const SquarePoint& point) const;

  // Its inverse for one slice: the point that the slice sends to `uniform` in [0, 1]^2. Where the
  // density vanishes there are several; one of them.
  SquarePoint Sample(int slice, const SquarePoint& uniform) const;

 private:
  BilinearStack density_;
  std::vector<double> row_integral_;  // [slices][rows][columns]: along the row up to each node
  std::vector<double> marginal_;      // [slices][rows]: over all rows up to each
};

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_BILINEAR_WARP_H_
