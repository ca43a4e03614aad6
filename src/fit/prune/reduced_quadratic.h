#ifndef TRILOBE_FIT_PRUNE_REDUCED_QUADRATIC_H_
#define TRILOBE_FIT_PRUNE_REDUCED_QUADRATIC_H_

#include <span>
#include <vector>

#include "solvers/joint/reduction.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// Of E's quadratic model: moves cost this much in addition, in units in which the diagonal of J'J
// is
// 1. E is a quadratic near x only, and parameters that the data hardly see could move far away:
//   with 1e-6 predictions are worthless (docs/pruning.md).
inline constexpr double kQuadraticDamping = 1e-3;

// E is flat where scale moves between a table and s, and a quadratic knows no end of that: it would
// meet a constraint by scaling the table to 0. This adds to H what holds the size of each table:
// the part of its change along itself counts in full, lengths being those that `scale` makes of
// parameters y. `parts` are those of y, and the first of them that is a table is `first_table`.
void HoldTableSizes(std::span<const FactorModel::Part> parts, int first_table,
                    std::span<const double> y, std::span<const double> scale, QuadraticModel* at);

struct ReducedPoint {
  std::vector<double> y;
  double rise = 0;  // of E, predicted
};

// Where E is lowest in the parameters y >= 0 of a reduction, by its quadratic `at` of a point x,
// and by how much it rises from there. Table sizes stay near those of y0. `lobes`: of the model.
ReducedPoint LowestWithin(const Reduction& reduction, const QuadraticModel& at,
                          std::span<const double> x, std::span<const double> y0, int lobes);

// H (to - from).
std::vector<double> GradientChange(const QuadraticModel& at, std::span<const double> from,
                                   std::span<const double> target);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_REDUCED_QUADRATIC_H_
