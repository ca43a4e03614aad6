#ifndef TRILOBE_FIT_CHOOSE_HELD_OUT_H_
#define TRILOBE_FIT_CHOOSE_HELD_OUT_H_

#include "fit/held_out.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/prune/model_choice.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// ChooseModel for samples that make no picture: forms are fitted to a part of them, judged by the
// others, and the one that is chosen is fitted to all. `fitted`, a fit to all in canonical form, is
// returned as it is unless another form is ahead of it by more than half a decibel, or it has more
// parameters than there may be. Forms that reach far higher than it beyond the samples, or more
// than four times the largest measured value between them, are not taken. `solved`: of what was
// measured, and a prior's samples. E of candidates is of what they were fitted to.
ChosenModel ChooseModel(const Objective& solved, const HeldOutPart& held_out,
                        const FactorModel& fitted, int max_parameters, const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_CHOOSE_HELD_OUT_H_
