#ifndef TRILOBE_MODEL_SPLIT_LOBE_H_
#define TRILOBE_MODEL_SPLIT_LOBE_H_

#include "trilobe/model/factor_model.h"

namespace trilobe {

// The model with one lobe more and the same values: `lobe` keeps the narrow part of its D, the new
// last lobe gets the wide part and copies of all else. Needs a D for each lobe.
// Throws Error if there is no such lobe, if the model has kMaxLobes already, or if its lobes share
// D.
FactorModel SplitLobe(const FactorModel& model, int lobe);

// The lobe that reflects most: the largest sum of s in the canonical gauge.
int StrongestLobe(const FactorModel& canonical);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_SPLIT_LOBE_H_
