#ifndef TRILOBE_MODEL_EVALUATE_HALF_VECTOR_TABLE_H_
#define TRILOBE_MODEL_EVALUATE_HALF_VECTOR_TABLE_H_

#include <array>
#include <cstddef>
#include <vector>

#include "trilobe/model/model_spec.h"

namespace trilobe {

// A density over two numbers, y in [0, 1] and s in [0, 1], that depends on a direction wi: bilinear
// in (y, s) between nodes, and linear between nodes of wi. Bsdf has the half vectors' in it.
// Sampled by inversion, marginal first, so that samples move continuously with the random numbers.
template <typename Real>
class HalfVectorTable {
 public:
  // Nodes of y, ascending from 0 to 1; how many nodes of s there are from 0 to 1, 5 to 33, one more
  // than a multiple of 4; nodes of
  // theta_i, ascending from 0 [rad], and how many even steps of phi_i there are around the circle.
  struct Nodes {
    std::vector<double> y;
    int s = 5;
    std::vector<double> theta_i;
    int phi_i = 1;
  };

  HalfVectorTable() = default;
  // `values`, all finite and >= 0, of any scale: [theta_i][phi_i][y][s].
  HalfVectorTable(const Nodes& nodes, const std::vector<float>& values);

  // Where a direction lies between the nodes, and the y at which its density ends.
  struct Condition {
    int count = 0;
    std::array<int, 4> node{};
    std::array<Real, 4> weight{};
    Real end = 1;
    Real total = 0;  // the integral of what the density is in proportion to
  };
  Condition At(Real theta_i, Real phi_i, Real end) const;

  // What the density is in proportion to, of which Condition::total is the integral.
  Real Value(const Condition& at, Real y, Real s) const;

  // A pair with that density, by two numbers in [0, 1]; `value` is what it has there. total must
  // not be 0.
  struct Sample {
    Real y, s, value;
  };
  Sample Draw(const Condition& at, Real u_y, Real u_s) const;

  // What it is made of, for shaders, which have no objects: nodes, values [node of wi][y][s], and
  // of these the integrals over s, and over y up to each. [node of wi][y]
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
  std::vector<Real> of_row_;     // [node of wi][y]: integral over all s
  std::vector<Real> cumulated_;  // [node of wi][y]: that over y up to this one
  // Where searches begin, by bins: of theta_i, of y, and, for each node of wi, of parts of its
  // integral.
  std::vector<int> theta_guide_, y_guide_, row_guide_;
};

extern template class HalfVectorTable<double>;
extern template class HalfVectorTable<float>;

// sin^2 theta_h of the entries of D and some between them, from 0 to 1; where D is linear between
// its entries, so is a table in sin^2 theta_h between these, or nearly.
std::vector<double> NodesOfY(const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_EVALUATE_HALF_VECTOR_TABLE_H_
