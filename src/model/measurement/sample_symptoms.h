#ifndef TRILOBE_MODEL_MEASUREMENT_SAMPLE_SYMPTOMS_H_
#define TRILOBE_MODEL_MEASUREMENT_SAMPLE_SYMPTOMS_H_

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "model/measurement/largest_value.h"
#include "model/measurement/symptoms.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Symptoms of faults in scattered samples, as goniometers and spreadsheets have them;
// docs/your-data.md gives their reliability. All take samples with directions.

// Same as for tables (symptoms.h), over samples whose exchanged directions were measured, too, or
// lie within 4 degrees of those of another sample.
CosineSymptom CosineOf(const BrdfSamples& samples);

// Position of the brightest sample of each incidence with a highlight: at theta_i of at least 20
// degrees, and above three times the median.
struct HighlightSymptom {
  int incidences = 0;  // with a highlight
  int at_light = 0;    // of these, with it within 30 degrees of the azimuth of the light, and not
                       // within 10 degrees of the normal
  int at_normal = 0;   // nearer to the normal than half of theta_i
  // The last is above ten times the median, and three times what was measured at the mirror
  // direction. One such tells as much as two others.
  bool is_strong = false;
  bool IsAtLight() const { return IsMost(at_light); }
  bool IsAtNormal() const { return IsMost(at_normal); }
  bool IsDecided() const { return incidences >= 2 || (incidences == 1 && is_strong); }

 private:
  bool IsMost(int count) const { return IsDecided() && count > 0 && 5 * count >= 4 * incidences; }
};
HighlightSymptom HighlightOf(const BrdfSamples& samples);

// Whether angles are counted from the horizon. At theta_o = 0 all azimuths are one direction, whose
// spread, the median over the incidences of log(90th / 10th percentile), decides where it was
// measured. Else it is the reading in which log rho is more nearly a function of theta_h and
// theta_d: variances that such a function leaves, as angles were read and with 90 degrees minus
// each.
struct ElevationSymptom {
  double at_normal = -1;  // below 0: not measured
  double as_read = 0, as_elevations = 0;
  bool IsDecided() const { return at_normal >= 0 || IsThere() || IsReadRightly(); }
  bool IsThere() const {
    if (at_normal >= 0) return at_normal > 0.3;
    return as_read > 0.02 && as_elevations < as_read / 2;
  }

 private:
  bool IsReadRightly() const { return as_elevations > 0.02 && as_read < as_elevations / 2; }
};
ElevationSymptom ElevationsOf(const BrdfSamples& samples);

// The least that comes back of the light of each incidence that was measured: the sum of rho cos
// theta_o over the directions that lie within one and a half spacings of a sample of that
// incidence, of which the darkest of the three nearest counts. By steps of 5 degrees of theta_i.
struct ReflectedAtLeast {
  double theta_i = 0;  // [rad], a mean
  double albedo = 0;   // mean over the channels
};
std::vector<ReflectedAtLeast> ReflectedLightOf(const BrdfSamples& samples);
// The median over the incidences; 0 without.
double MedianReflected(const BrdfSamples& samples);

// The same where the plane of incidence was scanned on both sides: in rings about the normal or, if
// that is more, about the mirror direction, as bright as the darker of the two places where the
// scan leaves a ring. Rings about the mirror direction are narrower across the plane, by cos
// theta_i. Median over the incidences; 0 without scans.
double ReflectedLightOfScans(const BrdfSamples& samples);

// Whether theta_o is counted from the mirror direction, in scans of the plane of incidence at
// several theta_i: medians of |log(f / f exchanged)| as it was read, with a cosine more or less if
// that is better, and with theta_o counted so. Of satin and rough metals, whose lobes have no clear
// highlight.
struct FromMirrorSymptom {
  bool is_decided = false;
  double error = 0, error_from_mirror = 0;
  bool IsThere() const { return error > 0.1 && error_from_mirror < error / 3; }
};
FromMirrorSymptom FromMirrorOf(const BrdfSamples& samples);

// Directions that are there more than once, at equal azimuths of an anisotropic measurement, and
// how far apart their values are: the 95th percentile of |a - b| / ((a + b) / 2) over neighbours.
struct RepeatedDirections {
  int samples = 0;  // at such directions
  double apart = 0;
};
RepeatedDirections RepeatedDirectionsOf(const BrdfSamples& samples, bool anisotropic);

// Azimuth from -pi to pi; 0 on the side of the light.
inline double AzimuthFromLight(const SphericalAngles& at) {
  return std::remainder(at.phi_o - at.phi_i, 2 * kPi);
}

// The numbers of the samples of about one theta_i, by steps of 5 degrees.
std::map<int, std::vector<int>> ByIncidence(const BrdfSamples& samples);

// What the samples cannot tell of, and why: the symptoms above that they decide neither way. Empty
// if there is none.
std::string UndecidedIn(const Measurement& scattered);

// One sentence per symptom; empty if nothing looks wrong.
std::vector<std::string> SymptomsOfSamples(const Measurement& scattered);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SAMPLE_SYMPTOMS_H_
