#ifndef TRILOBE_MODEL_LOBES_LOBES_H_
#define TRILOBE_MODEL_LOBES_LOBES_H_

#include <span>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

// Models with other lobes: some of them, fewer, or more.

namespace trilobe {

// The model whose k-th lobe is a copy of lobes[k], with d as it is. A lobe may come several times.
// Throws Error if there is no such lobe, or if there are more than kMaxLobes.
FactorModel WithLobes(const FactorModel& model, std::span<const int> lobes);

// The same parameters under other stretches of the highlights.
FactorModel WithStretches(const FactorModel& model, const Stretches& stretches);

// The model without a lobe: its s is gone, and the tables that it had to itself.
// Throws Error if there is no such lobe.
FactorModel WithoutLobe(const FactorModel& model, int lobe);

// The model with `lobe` and `other` as one, in place of `lobe`: s is their sum, and the tables that
// each had to itself are averages, weighted by the sums of s in the channels that they serve. Best
// in the canonical form (gauge.h), in which s is a lobe's size.
// Throws Error if there are no two such lobes.
FactorModel WithLobesMerged(const FactorModel& model, int lobe, int other);

// The model with one lobe more and the same values: `lobe` keeps the narrow part of its D, the new
// last lobe gets the wide part and copies of all else. Needs a D for each lobe.
// Throws Error if there is no such lobe, if the model has kMaxLobes already, or if its lobes share
// D.
FactorModel SplitLobe(const FactorModel& model, int lobe);

// The lobe that reflects most: the largest sum of s in the canonical gauge.
int StrongestLobe(const FactorModel& canonical);

// The model on the axes of another spec, with as many lobes and the same sharing: each entry of a
// new table is what the old one says there. So an isotropic model becomes an anisotropic one that
// is round, and a model on few nodes one on many. Throws Error where lobes or sharing differ.
FactorModel WithAxes(const FactorModel& model, const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_LOBES_H_
