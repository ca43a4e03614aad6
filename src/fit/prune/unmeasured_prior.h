#ifndef TRILOBE_FIT_PRUNE_UNMEASURED_PRIOR_H_
#define TRILOBE_FIT_PRUNE_UNMEASURED_PRIOR_H_

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// What a model says where nothing was measured, for fits that go on from it: fitted to few samples,
// thinned, or moved to another reflectance, these would be free there, and entries that hardly a
// sample reads may take any value. It counts so little that it decides only what the data leave
// open.
class UnmeasuredPrior {
 public:
  // Speaks about the bins above the surface that are not among the objective's samples; where these
  // are on no grid, about directions farther from the normal than they are. It says the same in
  // every objective that it joins.
  UnmeasuredPrior(const Objective& objective, const FactorModel& model);

  // The objective, whose samples are some of the other's, with the prior's samples besides.
  Objective JoinTo(const Objective& objective) const;

 private:
  BrdfSamples samples_;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_UNMEASURED_PRIOR_H_
