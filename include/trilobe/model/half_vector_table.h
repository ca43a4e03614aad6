#ifndef TRILOBE_MODEL_HALF_VECTOR_TABLE_H_
#define TRILOBE_MODEL_HALF_VECTOR_TABLE_H_

#include <array>
#include <cstddef>
#include <vector>

#include "trilobe/core/base/angles.h"
#include "trilobe/model/model_spec.h"

namespace trilobe {

// The largest theta of wi and wo in tables for renderers (Bsdf, files) [rad]; beyond it they use
// the values at it. In models with splined cosines, such as the paper's, G / cos theta is constant
// there.
inline constexpr double kGrazingTheta = DegreesToRadians(89.5);

// Nodes of y, ascending from 0 to 1; number of nodes of s from 0 to 1, 4 k + 1 in 5 to 129; nodes
// of theta_i, ascending from 0 [rad]; and number of even steps of phi_i around the circle.
struct HalfVectorNodes {
  std::vector<double> y;
  int s = 5;
  std::vector<double> theta_i;
  int phi_i = 1;
};

// A density over y and s in [0, 1], conditioned on a direction wi: bilinear in (y, s) between
// nodes, linear between nodes of wi. Bsdf uses it for half vectors. Sampling inverts the marginal
// first, so samples are continuous in the random numbers.
template <typename Real>
class HalfVectorTable {
 public:
  using Nodes = HalfVectorNodes;
  static constexpr int kMaxS = 129;  // nodes of s

  HalfVectorTable() = default;
  // `values`: unnormalised densities, finite and >= 0, [theta_i][phi_i][y][s].
  HalfVectorTable(const Nodes& nodes, const std::vector<float>& values);

  // A direction's nodes and weights, and the y at which its density ends.
  struct Condition {
    int count = 0;
    std::array<int, 4> node{};
    std::array<Real, 4> weight{};
    Real end = 1;
    Real total = 0;  // integral of the unnormalised density
  };
  Condition At(Real theta_i, Real phi_i, Real end) const;

  // The unnormalised density; its integral is Condition::total.
  Real Value(const Condition& at, Real y, Real s) const;

  // Draws (y, s) from two numbers in [0, 1]; `value` is the unnormalised density there. `total`
  // must not be 0.
  struct Sample {
    Real y, s, value;
  };
  Sample Draw(const Condition& at, Real u_y, Real u_s) const;

  // The raw arrays, for shaders: nodes, values [node of wi][y][s], their integrals over s [node of
  // wi][y], and the integrals of these over y up to each node [node of wi][y].
  const std::vector<Real>& y() const { return y_; }
  const std::vector<Real>& theta_i() const { return theta_i_; }
  int num_s() const { return num_s_; }
  int num_phi_i() const { return num_phi_i_; }
  const std::vector<float>& values() const { return values_; }
  const std::vector<Real>& of_row() const { return of_row_; }
  const std::vector<Real>& cumulated() const { return cumulated_; }

 private:
  int IntervalOfY(Real y) const;
  int RowWith(const Condition& at, Real wanted) const;
  Real Cumulated(const Condition& at, int row) const;
  Real OfRow(const Condition& at, int row) const;
  const float* Row(int node, int row) const {
    return &values_[(static_cast<size_t>(node) * y_.size() + row) * num_s_];
  }

  std::vector<Real> y_, theta_i_;
  int num_s_ = 0, num_phi_i_ = 1;
  std::vector<float> values_;    // [node of wi][y][s]
  std::vector<Real> of_row_;     // [node of wi][y]: integral over s
  std::vector<Real> cumulated_;  // [node of wi][y]: integral of that up to this y
  // Starting points of searches, by bins of theta_i, of y and, for each node of wi, of fractions of
  // its integral.
  std::vector<int> theta_guide_, y_guide_, row_guide_;
};

extern template class HalfVectorTable<double>;
extern template class HalfVectorTable<float>;

// Nodes of y = sin^2 theta_h, from 0 to 1: the entries of D and some between them, dense enough
// that linear interpolation in y reproduces a D that is linear between its entries, nearly.
std::vector<double> NodesOfY(const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_HALF_VECTOR_TABLE_H_
