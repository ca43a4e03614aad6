#ifndef TRILOBE_MODEL_MEASUREMENT_DARK_NOISE_H_
#define TRILOBE_MODEL_MEASUREMENT_DARK_NOISE_H_

#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

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

#endif  // TRILOBE_MODEL_MEASUREMENT_DARK_NOISE_H_
