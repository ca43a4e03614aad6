#ifndef TRILOBE_MODEL_MEASUREMENT_SAMPLE_DENSITY_H_
#define TRILOBE_MODEL_MEASUREMENT_SAMPLE_DENSITY_H_

#include <vector>

#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// Instruments measure a highlight densely, and a fit must not follow it at the price of all else.
// Adds up the multiplicities of scattered samples of an isotropic material in cells of 7.5 degrees
// of both theta and 15 degrees of azimuth. A cell counts at most as four times the median of those
// with samples: where it has more, its multiplicities are lowered; once more changes nothing.
// Without such a cell all stays as it is, to the bit, as do samples on a grid.
void EvenOutDensity(BrdfSamples* samples);

// The multiplicities that it sets.
std::vector<double> EvenMultiplicity(const BrdfSamples& samples);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SAMPLE_DENSITY_H_
