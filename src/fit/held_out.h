#ifndef TRILOBE_FIT_HELD_OUT_H_
#define TRILOBE_FIT_HELD_OUT_H_

#include <cstdint>
#include <vector>

#include "fit/prune/model_choice.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// The held-out samples that judge forms: about a fifth of the blocks of 2 degrees of theta_d by 2
// degrees of theta_h (less near the highlight). Whole blocks are held out because in dense rows of
// samples neighbours predict a single sample.
class HeldOutPart {
 public:
  // Splits measured samples; depends only on the seed and their angles. Throws Error for too few
  // samples.
  HeldOutPart(const BrdfSamples& measured, uint64_t seed, int num_threads);

  // Whether there would be both samples that are held out and others.
  static bool CanDivide(const BrdfSamples& measured, uint64_t seed);

  int size() const { return held_.size(); }
  const BrdfSamples& samples() const { return held_; }

  // The objective without the held-out samples. Its first samples must be the measured ones; those
  // of a prior follow and stay.
  Objective RemoveFrom(const Objective& objective) const;
  // The same of samples.
  BrdfSamples RemoveFrom(const BrdfSamples& samples) const;

  // Score of a model on the held-out samples [dB] (CompareSamples).
  double Score(const FactorModel& model) const;

 private:
  int num_measured_, num_threads_;
  std::vector<int> kept_;
  BrdfSamples held_;
};

// Refits a fit of all samples to a part of them.
FactorModel FitToPart(const Objective& part, FactorModel fitted, const StopCheck& stop);

// Least number of samples needed to choose a form of at most max_parameters parameters.
int LeastToHoldOut(int max_parameters);

// ChooseModel for samples without pictures: fits forms to the kept samples, judges them by the
// held-out ones, and fits the chosen form to all. `fitted` is a fit to all in canonical form. It is
// returned unchanged unless it exceeds max_parameters or another form leads by more than half a
// decibel. Forms with far larger values beyond the samples, or above four times the largest
// measured value between them, are rejected. `solved` has the measured samples and a prior's. E of
// a candidate is on the samples that it was fitted to.
ChosenModel ChooseModel(const Objective& solved, const HeldOutPart& held_out,
                        const FactorModel& fitted, int max_parameters, const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_HELD_OUT_H_
