#ifndef TRILOBE_SOLVERS_JOINT_REDUCTION_H_
#define TRILOBE_SOLVERS_JOINT_REDUCTION_H_

#include <span>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/quadratic_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// The parameters x of a model as sums of fewer parameters y >= 0:  x = B y,  B >= 0 and sparse.
// Every y_j is also the one x_k that it alone makes up, k = source()[j]. With E quadratic in x, it
// is so in y, by B'g and B'H B.
class Reduction {
 public:
  // y: the stored parameters of a model with this spec, in the order of parameters().
  Reduction(const ModelSpec& spec, const TableLayout& layout);

  // y: the parameters of a model whose spec `fewer` shares more tables than `spec` does, and has
  // the same lobes and table sizes.
  static Reduction BySharing(const ModelSpec& spec, const ModelSpec& fewer);

  // x = B y,  y = C z  to  x = B C z.
  Reduction ComposedWith(const Reduction& inner) const;

  int size() const { return static_cast<int>(source_.size()); }
  int num_parameters() const { return static_cast<int>(begin_.size()) - 1; }
  const std::vector<int>& source() const { return source_; }

  // Parameters of one kind in y, as FactorModel::Parts().
  const std::vector<FactorModel::Part>& parts() const { return parts_; }

  std::vector<double> Expand(std::span<const double> y) const;     // x
  std::vector<double> Restrict(std::span<const double> x) const;   // y_j = x[source_j]
  std::vector<double> Transpose(std::span<const double> x) const;  // B'x

  // The problem in y at the same point. Squared lengths as if the columns of J that make up one
  // column of J B were orthogonal, which they are but for those of neighbours in G.
  QuadraticModel operator()(const QuadraticModel& at) const;

 private:
  Reduction() = default;
  // Rows of B one by one, and new parameters of y with the row that is theirs alone.
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
