#ifndef TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_
#define TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_

#include <optional>
#include <vector>

#include "solvers/joint/joint_step.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Damped Gauss-Newton steps in the stretch exponents e of a model's lobes by variable projection
// (Golub, Pereyra 1973): the parameters x follow each step to the minimum of E. With the Jacobians
// J of x and K of e and the residuals r,
//   (K'K - K'J (J'J)^-1 J'K + lambda diag K'K) step = -(K'r - K'J (J'J)^-1 J'r),
// and x moves by -(J'J)^-1 (J'r + J'K step). Parameters at 0 that would decrease stay there.
class StretchStepper {
 public:
  // Prepares steps from an isotropic model. Slow: use it with few samples.
  StretchStepper(const Objective& objective, const FactorModel& model);

  // The model after a step. Exponents are rounded to hundredths and move by at most `max_step`; x
  // moves by the fraction `follow` (0 to 1) of its step. Lobes that share D share their stretch.
  // Nothing if no exponent would move.
  std::optional<FactorModel> Step(double lambda, double max_step, double follow = 1) const;

 private:
  std::vector<double> ExponentStep(double lambda) const;

  const FactorModel model_;
  int size_ = 0;  // exponents
  std::vector<int> free_;
  std::vector<double> gradient_, H_, squared_lengths_;  // of e; empty if J'J is not definite
  std::vector<std::vector<double>> follows_;            // (J'J)^-1 of J'r, J'K_1, J'K_2 ... [free]
};

// Fits stretches (in hundredths) and parameters by StretchStepper and JointSteps from an isotropic
// model `fitted`. Returns the model and its E. Builds an objective at every step, so use it with
// few samples; the spec of `objective` is ignored. Lobes that share D share their stretch. If
// stopped, returns the best model so far; otherwise the same bits for any number of threads.
SteppedModel FitStretches(const Objective& objective, const FactorModel& fitted,
                          const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_
