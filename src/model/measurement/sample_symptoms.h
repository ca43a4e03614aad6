#ifndef TRILOBE_MODEL_MEASUREMENT_SAMPLE_SYMPTOMS_H_
#define TRILOBE_MODEL_MEASUREMENT_SAMPLE_SYMPTOMS_H_

#include <string>
#include <vector>

#include "model/measurement/symptoms.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Symptoms of faults in scattered samples, as goniometers and spreadsheets have them;
// docs/robustness.md gives their reliability. All take samples with directions.

// As for tables (symptoms.h), of samples whose exchanged directions were measured, too, or lie
// within 4 degrees of those of another sample.
CosineSymptom CosineOf(const BrdfSamples& samples);

// Where the brightest sample of each incidence stands, of incidences with a highlight: whose
// brightest sample, at theta_i of 20 degrees and more, is at least three times the median.
struct HighlightSymptom {
  int incidences = 0;  // with a highlight
  int at_light = 0;    // of these, with it within 30 degrees of the azimuth of the light, and not
                       // within 10 degrees of the normal
  int at_normal = 0;   // within 3 degrees of the normal
  bool IsAtLight() const { return IsMost(at_light); }
  bool IsAtNormal() const { return IsMost(at_normal); }

 private:
  bool IsMost(int count) const { return count >= 2 && 5 * count >= 4 * incidences; }
};
HighlightSymptom HighlightOf(const BrdfSamples& samples);

// The least that comes back of the light of each incidence that was measured: the sum of rho cos
// theta_o over the directions that lie within one and a half spacings of a sample of that
// incidence, of which the darkest of the three nearest counts. By steps of 5 degrees of theta_i.
struct ReflectedAtLeast {
  double theta_i = 0;  // [rad], a mean
  double albedo = 0;   // mean over the channels
};
std::vector<ReflectedAtLeast> ReflectedLightOf(const BrdfSamples& samples);

// Directions that are there more than once, at equal azimuths of an anisotropic measurement, and
// how far apart their values are: the 90th percentile of |a - b| / ((a + b) / 2) over neighbours.
struct RepeatedDirections {
  int samples = 0;  // at such directions
  double apart = 0;
};
RepeatedDirections RepeatedDirectionsOf(const BrdfSamples& samples, bool anisotropic);

// The largest value of a channel, or the largest signal, rho cos theta_i, to 1e-9: how often it is
// there, at how many theta_h, and how many times as large as the next it is. The same value at one
// theta_h is what a BRDF of theta_h has.
struct LargestValueSymptom {
  double value = 0;
  int samples = 0, theta_h = 0;
  double over_next = 1;
  bool IsMark(int valid) const { return samples >= 2 && samples <= valid / 2 && over_next >= 20; }
  bool IsPlateau(int valid) const {
    return theta_h >= 3 && samples >= 5 && samples <= valid / 2 && !IsMark(valid);
  }
};
LargestValueSymptom LargestValueOf(const BrdfSamples& samples);

// One sentence per symptom; empty if nothing looks wrong.
std::vector<std::string> SymptomsOfSamples(const Measurement& scattered);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SAMPLE_SYMPTOMS_H_
