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

// A few parameters with a factor each.
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

// The minimum of a quadratic over parameters z >= 0 some of which, Z, are held at 0 while the
// others, F, are free; and how it answers to constraints. With the matrix A of the quadratic and
// its gradient q / 2 at the minimum, h = (z_F, -q_Z) and
//   T_FF = A_FF^-1,  T_FZ = -A_FF^-1 A_FZ,  T_ZZ = -(A_ZZ - A_ZF A_FF^-1 A_FZ),
// the principal pivot transform of A^-1. The columns of T_FZ are how the free parameters follow one
// of Z that is let go.
class Tableau {
 public:
  // All free. A: positive definite, column by column; it is taken over. Of no use if it is not.
  Tableau(std::vector<double> A, std::vector<double> z);

  bool valid() const { return valid_; }

  int size() const { return size_; }
  bool free(int k) const { return free_[k]; }
  double h(int k) const { return h_[k]; }
  void Set(int k, double h) { h_[k] = h; }

  // Holds a free parameter at 0, or lets it go; the change of the minimum.
  double Pivot(int k);

  // By how much the minimum rises if sum factor z = 0 over the terms, the first of which is let go
  // if it is held.
  double Rise(const Constraint& c) const;

  // Imposes it, its first parameter being free.
  void ImposeConstraint(const Constraint& c);

  // Forgets a parameter that follows from others. The last one takes its place.
  void Remove(int k);

 private:
  // Changes of T are of rank one and come one by one, and each would have to go through all of its
  // memory, while few entries are read in between. So they wait until there are some: it is
  //   T = T_ + U V',  the columns of U and V being t and factor t of those that wait.
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

// A node that is given up: its entry becomes linear between those that are left (WeightsAt).
struct Elimination {
  Factor factor = Factor::kD;
  int table = 0, entry = 0;
  double rise = 0;  // of E by this one and all before it, predicted, all other parameters refitted
};

struct EliminationLimits {
  double max_rise = 0;  // of E, predicted
  int max_count = 0;
  ThinnedFactors may_thin = {true, true, true};
};

// In which order to give up nodes of a model that was fitted in the parameters of its layout: the
// next one is always that which makes E rise least. `at` is the problem in all the model's
// parameters.
//
// E is taken for the quadratic of `at`, at whose minimum the model is taken to be. A node that
// becomes a combination of its neighbours is a linear constraint c'y = 0; with the covariance
// P = H^-1 of the parameters y it raises the minimum by (c'y)^2 / c'P c, and the minimum and P
// follow by updates of rank one. Parameters at the bound 0 are held there, by pivots on the same
// matrix (docs/pruning.md).
std::vector<Elimination> OrderOfElimination(const QuadraticModel& at, const FactorModel& model,
                                            const TableLayout& layout,
                                            const EliminationLimits& limits);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_NODE_ELIMINATION_H_
