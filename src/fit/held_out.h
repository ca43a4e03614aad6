#ifndef TRILOBE_FIT_HELD_OUT_H_
#define TRILOBE_FIT_HELD_OUT_H_

#include <cstdint>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/prune/model_choice.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// A part of the samples that forms are judged by, and not fitted to: about a fifth of the blocks of
// 2 degrees of theta_d and as much of theta_h (less near the highlight), each with all its samples.
// A sample that is left out alone its neighbours would tell, in the dense rows of a file of few wi.
class HeldOutPart {
 public:
  // Of these samples, which were measured; a function of the seed and their angles. Throws Error
  // where they are too few for two parts.
  HeldOutPart(const BrdfSamples& measured, uint64_t seed, int num_threads);

  int size() const { return held_.size(); }

  // The objective without them. Its first samples are those measured, and any others a prior's,
  // which stay.
  Objective RemoveFrom(const Objective& objective) const;

  // How much a model looks like the samples held out [dB] (CompareSamples).
  double Score(const FactorModel& model) const;

 private:
  int num_measured_, num_threads_;
  std::vector<int> kept_;
  BrdfSamples held_;
};

// A fit to all samples, led on by a part of them, so that it forgets the others.
FactorModel FitToPart(const Objective& part, FactorModel fitted, const StopCheck& stop);

// Fewer samples than this do not tell which form of at most so many parameters is the best.
int LeastToHoldOut(int max_parameters);

// ChooseModel for samples that make no picture: forms are fitted to a part of them, judged by the
// others, and the one that is chosen is fitted to all. `fitted`, a fit to all in canonical form, is
// returned as it is unless another form is ahead of it by more than half a decibel, or it has more
// parameters than there may be. Forms that reach far higher than it beyond the samples, or more
// than four times the largest measured value between them, are not taken. `solved`: of what was
// measured, and a prior's samples. E of candidates is of what they were fitted to.
ChosenModel ChooseModel(const Objective& solved, const HeldOutPart& held_out,
                        const FactorModel& fitted, int max_parameters, const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_HELD_OUT_H_
