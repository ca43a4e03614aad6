#ifndef TRILOBE_SOLVERS_JOINT_REDUCTION_H_
#define TRILOBE_SOLVERS_JOINT_REDUCTION_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Expresses the parameters x of a model by fewer parameters y >= 0:  x = B y,  B >= 0 and sparse.
// Each y_j equals one parameter x_k, k = source()[j]. A quadratic model g, H in x becomes B'g,
// B'H B in y.
class Reduction {
 public:
  // y: the stored parameters of `layout`, in the order of parameters().
  Reduction(const ModelSpec& spec, const TableLayout& layout);

  // y: the parameters of a model of spec `fewer`, which shares more tables than `spec` and has the
  // same lobes and table sizes.
  static Reduction BySharing(const ModelSpec& spec, const ModelSpec& fewer);

  // Composes x = B y with y = C z to x = B C z.
  Reduction ComposedWith(const Reduction& inner) const;

  int size() const { return static_cast<int>(source_.size()); }
  int num_parameters() const { return static_cast<int>(begin_.size()) - 1; }
  const std::vector<int>& source() const { return source_; }

  // Ranges of parameters of one kind in y, as FactorModel::Parts().
  const std::vector<FactorModel::Part>& parts() const { return parts_; }

  std::vector<double> Expand(std::span<const double> y) const;     // x
  std::vector<double> Restrict(std::span<const double> x) const;   // y_j = x[source_j]
  std::vector<double> Transpose(std::span<const double> x) const;  // B'x

  // The quadratic model in y at the same point. Squared lengths assume that the columns of J summed
  // by a column of B are orthogonal; only those of neighbours in G are not.
  QuadraticModel operator()(const QuadraticModel& at) const;

 private:
  Reduction() = default;
  // Build B row by row. NewColumn adds a parameter to y whose source is the current row.
  void Add(int column, double weight);
  void EndRow();
  int NewColumn();
  void EndPart();

  // Rows of B, [num_parameters + 1] and [nonzeros].
  std::vector<int> begin_ = {0};
  std::vector<int> column_;
  std::vector<double> weight_;
  std::vector<int> source_;
  std::vector<FactorModel::Part> parts_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_JOINT_REDUCTION_H_
