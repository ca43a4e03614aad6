#ifndef TRILOBE_MODEL_MERGE_LOBES_H_
#define TRILOBE_MODEL_MERGE_LOBES_H_

#include "trilobe/model/factor_model.h"

namespace trilobe {

// The model without a lobe: its s is gone, and the tables that it had to itself.
// Throws Error if there is no such lobe.
FactorModel WithoutLobe(const FactorModel& model, int lobe);

// The model with `lobe` and `other` as one, in place of `lobe`: s is their sum, and the tables that
// each had to itself are averages, weighted by the sums of s in the channels that they serve. Best
// in the canonical form (gauge.h), in which s is a lobe's size.
// Throws Error if there are no two such lobes.
FactorModel WithLobesMerged(const FactorModel& model, int lobe, int other);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MERGE_LOBES_H_
