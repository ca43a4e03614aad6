#ifndef TRILOBE_MODEL_MEASUREMENT_SYMPTOMS_H_
#define TRILOBE_MODEL_MEASUREMENT_SYMPTOMS_H_

#include <string>
#include <vector>

#include "trilobe/model/measurement/brdf_table.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// What the values of a table tell of its measurement, each with the limits beyond which it is told;
// docs/robustness.md says how often that is right.

// Were values multiplied by cos^k theta_i, log(rho / rho with wi and wo exchanged) would be
// k log(cos theta_i / cos theta_o): k is the median of the ratio of the two, over pairs whose
// cosines differ by a factor of 1.5 or more.
struct CosineSymptom {
  double exponent = 0;
  // Medians of |log(rho / rho exchanged)| over these pairs, as it is and with k = 1 or -1, the
  // nearer one, divided out.
  double error = 0, error_without = 0;
  bool IsOneTooMany() const { return IsFar() && exponent > 0.65; }
  bool IsOneTooFew() const { return IsFar() && exponent < -0.65; }

 private:
  bool IsFar() const { return error_without < error / 2; }
};
CosineSymptom CosineOf(const BrdfTable& table);

// Where the same light were added to all signals, the BRDF, which is divided by cos theta_i, would
// have it times 1/cos theta_i, and with its directions exchanged times 1/cos theta_o: its share of
// the median signal, by the median over the pairs of a cosine's symptom, and the error of these as
// it is and without that light.
struct StrayLightSymptom {
  double share = 0;
  double error = 0, error_without = 0;
  bool IsThere() const { return share > 0.005 && error_without < error / 2; }
};
StrayLightSymptom StrayLightOf(const BrdfTable& table);

// The angle [deg] beyond which theta_i makes no difference any more: to the last angle measured, 6
// degrees at least, all steps of 2 degrees change values by less than a tenth of what the five
// before did, in medians over theta_o from 10 to 45 degrees and all azimuths.
struct RepetitionSymptom {
  double degrees = 0;
  bool IsThere() const { return degrees > 0; }
};
RepetitionSymptom RepetitionOf(const BrdfTable& table);

// By how much values scatter about a parabola through their neighbours in phi_d: the standard
// deviation of normal noise of log rho that has the same median of third differences, of the green
// of every third row.
struct NoiseSymptom {
  double relative = 0;
  bool IsThere() const { return relative > 0.03; }
};
NoiseSymptom NoiseOf(const BrdfTable& table);

// How many values have the largest signal, rho cos theta_i, of their channel, or the largest rho,
// to 1e-9, and of how many rows of one theta_h and theta_d: where a detector was saturated there is
// a plateau. One row may be constant without that, as of a BRDF of theta_h and theta_d only, and so
// may be more than half of a table, as of a matt one.
struct PlateauSymptom {
  int values = 0, rows = 0, valid = 0;
  bool IsThere() const { return values >= 10 && rows >= 2 && values <= valid / 2; }
};
PlateauSymptom PlateauOf(const BrdfTable& table);

// The share of the darker half of the signals above 0 that have another one within 1e-9, the green
// of every third row, one order of the directions: a quantised measurement has few different ones.
struct QuantizationSymptom {
  double share = 0;
  bool IsThere() const { return share > 0.1; }
};
QuantizationSymptom QuantizationOf(const BrdfTable& table);

// By how much the middle of the highlight is off theta_h = 0, towards wi [deg]: the median over
// theta_d from 10 to 60 degrees of the centroid of what is above half of the largest value within
// theta_h = 15 degrees, where that is three times as bright as the rim; and how far its quartiles
// are apart. There is a highlight where ten theta_d at least have one.
struct TiltSymptom {
  bool highlight = false;
  double degrees = 0, spread = 0;
  bool IsThere() const {
    return (degrees > 0.4 || degrees < -0.4) && 2 * spread < (degrees < 0 ? -degrees : degrees);
  }
};
TiltSymptom TiltOf(const BrdfTable& table);

// A sentence each; empty where nothing looks wrong.
std::vector<std::string> SymptomsOf(const BrdfTable& table, int num_threads);

// Adds those of a measurement that has a table to its notes.
void NoteSymptoms(int num_threads, Measurement* measurement);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SYMPTOMS_H_
