#ifndef TRILOBE_MODEL_MEASUREMENT_BAD_READINGS_H_
#define TRILOBE_MODEL_MEASUREMENT_BAD_READINGS_H_

#include <vector>

#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

struct Outlier {
  int sample = 0;     // its number
  double median = 0;  // of what surrounds it [1/sr]
  bool far = true;    // by more than 8 times
};

// The samples that are far off what surrounds them: a dead reading, a glint. Such a
// sample is more than 8 times brighter or darker, in the mean over the channels, than the median of
// the samples around it, itself included: of 3 x 3 x 5 bins of theta_h, theta_d and phi_d or, where
// these hold fewer than 9, of two, four or eight times as many of theta_d and phi_d to each side;
// where all hold fewer, it is none. A highlight falls by less from one theta_h to the next, and a
// median has half of the samples on either side. The same must be true of the median of those of
// its own theta_h, and of its own theta_d, where they are 9: all samples of a theta_h or theta_d
// may be darker than the next ones, as an entry of D or F says. Where the samples in the nearest
// bins of a table agree better than that, less is enough (Hampel 1974): a sample that is more than
// twice as bright or dark as each of these medians, by more than 7 times the median difference of
// the samples' own logarithms. Scattered samples lie in the bins of their grid, as those of a table
// do. Ascending. The same for any number of threads.
std::vector<Outlier> FindOutliers(const BrdfSamples& samples, int num_threads);

// By how much they are off the medians, as a share of the reflected light that the others and these
// medians have: sum W c |rho - median| / sum W c rho, of means over the channels, with solid angles
// W and c = cos theta_i cos theta_o.
double LightOf(const std::vector<Outlier>& outliers, const BrdfSamples& samples);

// Noise of one channel that does not fall with its signal b = rho cos theta_i, as dark current and
// read-out make: by third differences along phi_d, of every third row. Of each four neighbours
// these are 0 where b is a parabola, and sqrt(20) times its noise where that is independent; the
// medians of their absolute values, each over a quarter of all from the darkest to the brightest
// fours, tell the noise there.
struct DarkNoise {
  double deviation = 0;  // standard deviation of b, of the second quarter: the darkest have been
                         // cut off at 0
  double relative = 0;   // noise over signal in the darkest quarter
  double rise = 0;       // that, over noise over signal in the third: 1 where noise is a share of b
  double alternating = 0;  // share of successive differences of the darkest that differ in sign:
                           // 3/4 of noise, and few of a smooth table of few bins
  bool IsThere() const { return relative > 0.05 && rise > 1.5 && alternating > 0.6; }
};
DarkNoise DarkNoiseOf(const BrdfTable& table, int channel);

// Where the dark noise of a channel, if there is any, is more than a tenth of the signal around a
// bin, its value becomes the median of what surrounds it: of the valid ones of 3 x 3 x 5 bins of
// theta_h, theta_d and phi_d or, where these are fewer than 9, of up to eight times as many of
// theta_d and phi_d to each side. A mean would be too bright where signals below 0 have been cut
// off. A value that itself is more than 20 times the noise, as of a narrow highlight, stays.
// Returns how many bins have a new value. The same for any number of threads.
int SmoothDarkReadings(int num_threads, BrdfTable* table);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_BAD_READINGS_H_
