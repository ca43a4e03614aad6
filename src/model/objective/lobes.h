#ifndef TRILOBE_MODEL_OBJECTIVE_LOBES_H_
#define TRILOBE_MODEL_OBJECTIVE_LOBES_H_

#include <span>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/model_spec.h"

// Adding, removing, splitting and merging lobes of a model.

namespace trilobe {

// The model whose k-th lobe is a copy of lobes[k]; d is unchanged. A lobe may occur several times.
// Throws Error if there is no such lobe, or for more than kMaxLobes.
FactorModel WithLobes(const FactorModel& model, std::span<const int> lobes);

// The same parameters with other stretches.
FactorModel WithStretches(const FactorModel& model, const Stretches& stretches);

// The model without a lobe's s and its own tables. Throws Error if there is no such lobe.
FactorModel WithoutLobe(const FactorModel& model, int lobe);

// The model with `lobe` and `other` merged in the place of `lobe`: s is their sum, and their own
// tables are averaged, weighted by the sum of s over each table's channels. Most accurate in
// canonical form (gauge.h), where s is the size of a lobe. Throws Error unless both lobes exist and
// differ.
FactorModel WithLobesMerged(const FactorModel& model, int lobe, int other);

// The model with a lobe split in two, with unchanged values: `lobe` keeps the narrow part of its D;
// a new last lobe gets the wide part and copies of all else. Throws Error if there is no such lobe,
// the model has kMaxLobes, or lobes share D.
FactorModel SplitLobe(const FactorModel& model, int lobe);

// The lobe that reflects most: the largest sum of s in canonical form.
int StrongestLobe(const FactorModel& canonical);

// The model resampled to the axes of another spec with the same number of lobes and sharing: each
// new entry is the old table's value at its position. It turns an isotropic model into a
// rotationally symmetric anisotropic one, or refines the nodes. Throws Error if lobes or sharing
// differ.
FactorModel WithAxes(const FactorModel& model, const ModelSpec& spec);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_LOBES_H_
