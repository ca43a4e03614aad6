#ifndef TRILOBE_FIT_FINISH_LIGHT_REFIT_H_
#define TRILOBE_FIT_FINISH_LIGHT_REFIT_H_

#include <vector>

#include "fit/finish/light_bounds.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Refits a model that reflects more than it may, so that E rises as little as it can: damped
// Gauss-Newton steps in the logarithms y of the stored parameters minimise
//   E + price sum_bounds sum_c max(0, log(A_c / limit_c))^2 + epsilon |y - y(model)|^2
// for ever higher prices, until all bounds are kept to about a hundredth. Entries that no sample
// reads cost nothing but the last term, which is small, so that light beyond the data gives way
// first. An isotropic model has one azimuth, 0. The same bits for any number of threads. Throws
// Error for a model, layout or objective of another spec.
FactorModel RefitWithinBounds(const std::vector<LightBound>& bounds, const Objective& objective,
                              const TableLayout& layout, const FactorModel& model,
                              const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_LIGHT_REFIT_H_
