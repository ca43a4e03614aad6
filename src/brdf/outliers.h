#ifndef TRILOBE_BRDF_OUTLIERS_H_
#define TRILOBE_BRDF_OUTLIERS_H_

#include <vector>

#include "trilobe/brdf/brdf_samples.h"

namespace trilobe {

// The numbers of the samples that are far off what surrounds them: a dead reading, a glint. Such a
// sample is more than 8 times brighter or darker, in the mean over the channels, than the median of
// the samples around it, itself included: of 3 x 3 x 5 bins of theta_h, theta_d and phi_d or, where
// these hold fewer than 9, of two, four or eight times as many of theta_d and phi_d to each side;
// where all hold fewer, it is none. A highlight falls by less from one theta_h to the next, and a
// median has half of the samples on either side. The same must be true of the median of those of
// its own theta_h, and of its own theta_d, where they are 9: all samples of a theta_h or theta_d
// may be darker than the next ones, as an entry of D or F says. Scattered samples lie in the bins
// of their grid, as those of a table do. Ascending. The same for any number of threads.
std::vector<int> FindOutliers(const BrdfSamples& samples, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_BRDF_OUTLIERS_H_
