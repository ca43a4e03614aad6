#ifndef TRILOBE_MODEL_MEASUREMENT_LARGEST_VALUE_H_
#define TRILOBE_MODEL_MEASUREMENT_LARGEST_VALUE_H_

#include <string>

#include "trilobe/model/measurement/brdf_samples.h"

namespace trilobe {

// The largest value of a channel, or the largest signal, rho cos theta_i, to 1e-6: how often and at
// how many pairs of directions it is there, of which two that are exchanged, mirrored, or at the
// normal count once, at how many theta_h (of signals: or theta_i, if these are more), and how many
// times as large as the next it is. The same value at one theta_h is what a BRDF of theta_h has. A
// value of nines, as 9999, is a mark whatever the next is; another that stands about the mirror
// direction is a highlight.
struct LargestValueSymptom {
  double value = 0;
  int samples = 0, pairs = 0, angles = 0;
  double theta_h = 0;  // [rad] the median
  double over_next = 1;
  bool is_nines = false, of_signal = false;
  bool IsMark(int valid) const {
    constexpr double kHighlight = 0.1;  // [rad]
    return pairs >= 2 && samples <= valid / 2 &&
           (is_nines || (over_next >= 20 && theta_h > kHighlight));
  }
  bool IsPlateau(int valid) const {
    return angles >= 3 && pairs >= 4 && samples <= valid / 2 && !IsMark(valid);
  }
};
LargestValueSymptom LargestValueOf(const BrdfSamples& samples);
// Whether a sample has it.
bool HasLargest(const LargestValueSymptom& largest, const BrdfSamples& samples, int j);
// "the value 9999 is there 52 times, and is 8645 times the next one: it seems to mark what was not
// measured".
std::string MarkText(const LargestValueSymptom& largest);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_LARGEST_VALUE_H_
