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

// Finds samples far off their neighbourhood, such as dead readings and glints. The neighbourhood is
// 3 x 3 x 5 bins of theta_h, theta_d and phi_d, with the sample itself; if it has fewer than 9
// samples, two, four or eight times as many bins of theta_d and phi_d to each side; if it still has
// fewer, the sample is not an outlier. An outlier is more than 8 times brighter or darker, in the
// mean over the channels, than the neighbourhood's median; a highlight changes less per theta_h
// bin. The same must hold for the medians of the neighbours with the same theta_h, and with the
// same theta_d, if there are 9: a whole theta_h or theta_d may be darker than the next, as an entry
// of D or F. In the nearest bins of a table a smaller deviation suffices if the neighbours agree
// (Hampel 1974): a factor above 2 from each of these medians, and in the logarithm more than 7
// times the neighbours' median deviation. Scattered samples are sorted into the bins of their grid.
// Ascending. The same for any number of threads.
std::vector<Outlier> FindOutliers(const BrdfSamples& samples, int num_threads);

// Deviation of outliers from the medians as a fraction of the reflected light with outliers
// replaced by medians: sum W c |rho - median| / sum W c rho, of means over the channels, with solid
// angles W and c = cos theta_i cos theta_o.
double LightOf(const std::vector<Outlier>& outliers, const BrdfSamples& samples);

// Noise of one channel that does not decrease with its signal b = rho cos theta_i, as from dark
// current and read-out. Estimated from third differences along phi_d, of every third row: for four
// neighbours they are 0 if b is a parabola, and sqrt(20) times the noise if that is independent.
// The medians of their absolute values, over each quarter of all groups of four from the darkest to
// the brightest, give the noise there.
struct DarkNoise {
  double deviation = 0;    // standard deviation of b, of the second quarter: the darkest have been
                           // cut off at 0
  double relative = 0;     // noise over signal in the darkest quarter
  double rise = 0;         // `relative` over the third quarter's: 1 where noise is a share of b
  double alternating = 0;  // share of successive differences of the darkest that differ in sign:
                           // 3/4 for noise, few for a smooth table of few bins
  bool IsThere() const { return relative > 0.05 && rise > 1.5 && alternating > 0.6; }
};
DarkNoise DarkNoiseOf(const BrdfTable& table, int channel);

// If the dark noise of a channel exceeds a tenth of the signal around a bin, the value becomes the
// median of the valid values around it: of 3 x 3 x 5 bins of theta_h, theta_d and phi_d or, if
// these are fewer than 9, of up to eight times as many of theta_d and phi_d to each side. (A mean
// would be too bright if signals below 0 were cut off.) Values above 20 times the noise, as in
// narrow highlights, are kept. Returns the number of changed bins. The same for any number of
// threads.
int SmoothDarkReadings(int num_threads, BrdfTable* table);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_BAD_READINGS_H_
