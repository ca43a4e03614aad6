#ifndef TRILOBE_MODEL_OBJECTIVE_RECONSTRUCT_H_
#define TRILOBE_MODEL_OBJECTIVE_RECONSTRUCT_H_

#include <string>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// The model's BRDF [1/sr] at every sample, in order. If the grid has the theta_h and theta_d bins
// of the spec, D and F are read at their own bins, else interpolated (docs/model.md). Huge factors
// may overflow to infinity or NaN. Throws Error for invalid samples (CheckSamples).
std::vector<Rgb> EvaluateSamples(const FactorModel& model, const BrdfSamples& samples,
                                 int num_threads);

// The same without clamping at 0, as E compares it with the measurement (UnclampedValue).
std::vector<Rgb> UnclampedSamples(const FactorModel& model, const BrdfSamples& samples,
                                  int num_threads);

// The model as a MERL table: EvaluateSamples at all bins above the surface; other bins are invalid.
// `source` is the table's name in messages. Throws Error if a value overflows.
BrdfTable Reconstruct(const FactorModel& model, const std::string& source,
                      const MerlGrid& grid = {}, int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_RECONSTRUCT_H_
