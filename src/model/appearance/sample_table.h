#ifndef TRILOBE_MODEL_APPEARANCE_SAMPLE_TABLE_H_
#define TRILOBE_MODEL_APPEARANCE_SAMPLE_TABLE_H_

#include <optional>

#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Scattered samples of an isotropic material as a table, for pictures: the mean of those in each
// bin of the finest of a few grids that has four times as many samples as bins, and at least one in
// 60 % of the bins; the others are invalid. Nothing where samples are too few, as in car paints
// that lack what was dark, or azimuths matter.
std::optional<BrdfTable> TableOfSamples(const Measurement& scattered);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_APPEARANCE_SAMPLE_TABLE_H_
