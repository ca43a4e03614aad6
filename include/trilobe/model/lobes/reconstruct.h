#ifndef TRILOBE_MODEL_LOBES_RECONSTRUCT_H_
#define TRILOBE_MODEL_LOBES_RECONSTRUCT_H_

#include <string>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// The model's BRDF [1/sr] at every sample, in their order. On a grid whose theta_h and theta_d bins
// are those of the spec, D and F are read at their own bins; elsewhere they are interpolated
// (docs/model.md). Nothing stops the product of huge factors from overflowing to infinity or NaN.
// Throws Error for samples that are none (CheckSamples).
std::vector<Rgb> EvaluateSamples(const FactorModel& model, const BrdfSamples& samples,
                                 int num_threads);

// The same without the bound at 0: what E compares with the measurement (UnclampedValue).
std::vector<Rgb> UnclampedSamples(const FactorModel& model, const BrdfSamples& samples,
                                  int num_threads);

// The model in MERL layout: EvaluateSamples at all bins above the surface, the others invalid.
// `source` names the table in messages. Throws Error if a value overflows.
BrdfTable Reconstruct(const FactorModel& model, const std::string& source,
                      const MerlGrid& grid = {}, int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_LOBES_RECONSTRUCT_H_
