#ifndef TRILOBE_FIT_PRUNE_NODE_ELIMINATION_H_
#define TRILOBE_FIT_PRUNE_NODE_ELIMINATION_H_

#include <array>
#include <cstddef>
#include <vector>

#include "fit/prune/stored_layouts.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// A linear constraint sum factor z = 0 on up to three parameters.
struct Term {
  int row;
  double factor;
};
struct Constraint {
  std::array<Term, 3> terms;
  int size = 0;
  void Add(int row, double factor) { terms[size++] = {row, factor}; }
  const Term* begin() const { return terms.data(); }
  const Term* end() const { return terms.data() + size; }
};

// The minimum of a quadratic over parameters z >= 0, of which Z are held at 0 and F are free, and
// its response to constraints. With the matrix A of the quadratic and its gradient q / 2 at the
// minimum, h = (z_F, -q_Z) and
//   T_FF = A_FF^-1,  T_FZ = -A_FF^-1 A_FZ,  T_ZZ = -(A_ZZ - A_ZF A_FF^-1 A_FZ),
// the principal pivot transform of A^-1. A column of T_FZ is the response of the free parameters to
// one of Z that is released.
class Tableau {
 public:
  // All parameters are free. A: by columns; not valid() unless positive definite.
  Tableau(std::vector<double> A, std::vector<double> z);

  bool valid() const { return valid_; }

  int size() const { return size_; }
  bool free(int k) const { return free_[k]; }
  double h(int k) const { return h_[k]; }
  void Set(int k, double h) { h_[k] = h; }

  // Holds a free parameter at 0 or releases a held one. Returns the change of the minimum.
  double Pivot(int k);

  // Rise of the minimum by a constraint. Its first parameter is released if it is held.
  double Rise(const Constraint& c) const;

  // Imposes a constraint, whose first parameter must be free.
  void ImposeConstraint(const Constraint& c);

  // Removes a parameter that follows from others. The last one takes its place.
  void Remove(int k);

 private:
  // Updates of T have rank one and would each pass over all of its memory, while few entries are
  // read in between. So they are collected:
  //   T = T_ + U V',  the columns of U and V being t and factor t of the waiting updates.
  static constexpr int kMaxWaiting = 16;

  double At(int i, int j) const {
    double sum = T_[i * stride_ + j];
    const double *const u = U_.data() + i * kMaxWaiting, *const v = V_.data() + j * kMaxWaiting;
    for (int p = 0; p < waiting_; ++p) sum += u[p] * v[p];
    return sum;
  }
  // T += factor t_ t_'.
  void AddOuterProduct(double factor);

  const size_t stride_;
  int size_;
  bool valid_ = false;
  std::vector<double> T_, U_, V_;  // row by row
  int waiting_ = 0;
  std::vector<double> h_;
  std::vector<bool> free_;
  std::vector<double> t_;
};

// An eliminated node: its entry becomes linear between the remaining ones (WeightsAt).
struct Elimination {
  Factor factor = Factor::kD;
  int table = 0, entry = 0;
  double rise = 0;  // of E by this and all earlier ones, predicted with the others refitted
};

struct EliminationLimits {
  double max_rise = 0;  // of E, predicted
  int max_count = 0;
  ThinnedFactors may_thin = {true, true, true};
};

// The order in which to eliminate nodes of a model fitted in the parameters of its layout: next is
// always the node with the least rise of E. `at` is the quadratic model in all parameters.
//
// E is approximated by `at`, with the model at its minimum. A node that becomes a combination of
// its neighbours is a linear constraint c'y = 0. With the covariance P = H^-1 of the parameters y
// it raises the minimum by (c'y)^2 / c'P c; rank-one updates give the new minimum and P. Parameters
// at the bound 0 are held there by pivots on the same matrix (docs/forms.md).
std::vector<Elimination> OrderOfElimination(const QuadraticModel& at, const FactorModel& model,
                                            const TableLayout& layout,
                                            const EliminationLimits& limits);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_NODE_ELIMINATION_H_
