#ifndef TRILOBE_FIT_PRUNE_UNMEASURED_PRIOR_H_
#define TRILOBE_FIT_PRUNE_UNMEASURED_PRIOR_H_

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// Samples of a model where nothing was measured. They hold fits that continue from the model (to
// few samples, in fewer parameters, or to another reflectance) where the data do not determine
// them. Their weight is small, so the data decide elsewhere.
class UnmeasuredPrior {
 public:
  // Takes samples at the bins above the surface that the objective lacks; for samples on no grid,
  // at directions farther from the normal than these.
  UnmeasuredPrior(const Objective& objective, const FactorModel& model);

  bool empty() const { return samples_.rho.empty(); }

  // Adds the samples to an objective of a part of the samples.
  Objective JoinTo(const Objective& objective) const;

 private:
  BrdfSamples samples_;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_UNMEASURED_PRIOR_H_
