#ifndef TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_
#define TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_

#include <optional>
#include <vector>

#include "solvers/joint/joint_step.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Damped Gauss-Newton steps of the exponents by which a model's lobes are stretched, with all its
// parameters following: variable projection (Golub, Pereyra 1973). With J of the parameters x, K of
// the exponents e and the residuals r, x follows a step of e to where E is lowest, so that the step
// solves the normal equations of K less what J explains of it,
//   (K'K - K'J (J'J)^-1 J'K + lambda diag K'K) step = -(K'r - K'J (J'J)^-1 J'r),
// and x moves by -(J'J)^-1 (J'r + J'K step). Parameters that are 0 and would fall stay.
class StretchStepper {
 public:
  // Prepares steps from an isotropic model. For few samples: it passes over them one by one.
  StretchStepper(const Objective& objective, const FactorModel& model);

  // The model after such a step, exponents in whole hundredths, each at most `max_step` away, and
  // x moved by the share `follow` of its own step, from 0 to 1. Lobes that share D have one stretch
  // together. None if no exponent would move.
  std::optional<FactorModel> Step(double lambda, double max_step, double follow = 1) const;

 private:
  std::vector<double> ExponentStep(double lambda) const;

  const FactorModel model_;
  int size_ = 0;  // exponents
  std::vector<int> free_;
  std::vector<double> gradient_, H_, squared_lengths_;  // of e; empty if J'J is not definite
  std::vector<std::vector<double>> follows_;            // (J'J)^-1 of J'r, J'K_1, J'K_2 ... [free]
};

// A model whose lobes are stretched, in whole hundredths, as steps of all exponents and parameters
// (StretchStepper, JointSteps) lead to from `fitted`, an isotropic one, and E there. For few
// samples, of which an objective is made anew at every step; its own spec does not matter. Lobes
// that share D have one stretch together. Once `stop` is true the best so far is returned. The same
// bits for any number of threads, as long as it stays false.
SteppedModel FitStretches(const Objective& objective, const FactorModel& fitted,
                          const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_STRETCH_SEARCH_H_
