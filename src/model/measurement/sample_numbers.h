#ifndef TRILOBE_MODEL_MEASUREMENT_SAMPLE_NUMBERS_H_
#define TRILOBE_MODEL_MEASUREMENT_SAMPLE_NUMBERS_H_

#include <vector>

#include "trilobe/core/base/merl_grid.h"

namespace trilobe {

// Numbers of the samples that Thinned takes if they are scattered, and EvenlySpread; ascending.
std::vector<int> ThinnedNumbers(int size, int stride);
std::vector<int> EvenlySpreadNumbers(int size, const MerlGrid& grid, int count);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SAMPLE_NUMBERS_H_
