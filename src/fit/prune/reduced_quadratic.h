#ifndef TRILOBE_FIT_PRUNE_REDUCED_QUADRATIC_H_
#define TRILOBE_FIT_PRUNE_REDUCED_QUADRATIC_H_

#include <span>
#include <vector>

#include "solvers/joint/reduction.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/quadratic_model.h"

namespace trilobe {

// Damping added to the quadratic model of E, with the diagonal of J'J scaled to 1. E is quadratic
// only near x, and parameters that the data hardly determine could move far: with 1e-6, predictions
// are worthless (docs/forms.md).
inline constexpr double kQuadraticDamping = 1e-3;

// Adds a penalty to H that holds the size of each table. E is flat where scale moves between a
// table and s, so a quadratic model would meet a constraint by scaling the table to 0. The penalty
// applies to the component of a table's change along the table itself, in lengths of `scale` times
// y. `parts` are those of y; the first table among them is `first_table`.
void HoldTableSizes(std::span<const FactorModel::Part> parts, int first_table,
                    std::span<const double> y, std::span<const double> scale, QuadraticModel* at);

struct ReducedPoint {
  std::vector<double> y;
  double rise = 0;  // of E, predicted
};

// The minimum over y >= 0, the parameters of a reduction, of the quadratic model `at` of E around a
// point x, and the rise of E from x. Table sizes stay near those of y0. `lobes`: of the model.
ReducedPoint LowestWithin(const Reduction& reduction, const QuadraticModel& at,
                          std::span<const double> x, std::span<const double> y0, int lobes);

// H (to - from).
std::vector<double> GradientChange(const QuadraticModel& at, std::span<const double> from,
                                   std::span<const double> target);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_REDUCED_QUADRATIC_H_
