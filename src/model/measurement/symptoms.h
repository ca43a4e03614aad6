#ifndef TRILOBE_MODEL_MEASUREMENT_SYMPTOMS_H_
#define TRILOBE_MODEL_MEASUREMENT_SYMPTOMS_H_

#include <string>
#include <vector>

#include "trilobe/model/measurement/brdf_table.h"

namespace trilobe {

// Symptoms of faults in the values of a table, each with its reporting threshold;
// docs/your-data.md gives their reliability.

// If values were multiplied by cos^k theta_i, log(rho / rho with wi and wo exchanged) would be k
// log(cos theta_i / cos theta_o). k is the median ratio of the two, over pairs whose cosines differ
// by a factor of at least 1.5.
struct CosineSymptom {
  bool is_decided = false;  // exchanged directions were measured
  double exponent = 0;
  // Medians of |log(rho / rho exchanged)| over these pairs, as measured and after dividing by the
  // cosines with k = 1 or -1, the nearer one.
  double error = 0, error_without = 0;
  bool IsOneTooMany() const { return IsFar() && exponent > 0.65; }
  bool IsOneTooFew() const { return IsFar() && exponent < -0.65; }

 private:
  bool IsFar() const { return error_without < error / 2; }
};
CosineSymptom CosineOf(const BrdfTable& table);

// If the same light were added to all signals, the BRDF, which is divided by cos theta_i, would
// contain it times 1/cos theta_i, and when exchanged times 1/cos theta_o. Gives the light as a
// fraction of the median signal, by the median over the pairs of the cosine symptom, and their
// error with and without it.
struct StrayLightSymptom {
  double share = 0;
  double error = 0, error_without = 0;
  bool IsThere() const { return share > 0.005 && error_without < error / 2; }
};
StrayLightSymptom StrayLightOf(const BrdfTable& table);

// The angle [deg] beyond which values no longer depend on theta_i: from there to the last measured
// angle, at least 6 degrees, each step of 2 degrees changes values by less than a tenth of the
// change in the five steps before, by medians over theta_o from 10 to 45 degrees and all azimuths.
struct RepetitionSymptom {
  double degrees = 0;
  bool IsThere() const { return degrees > 0; }
};
RepetitionSymptom RepetitionOf(const BrdfTable& table);

// Scatter of values about a parabola through their neighbours in phi_d: the standard deviation of
// normal noise of log rho with the same median third difference, from the green channel of every
// third row.
struct NoiseSymptom {
  double relative = 0;
  bool IsThere() const { return relative > 0.03; }
};
NoiseSymptom NoiseOf(const BrdfTable& table);

// Number of values with the largest signal, rho cos theta_i, of their channel or with the largest
// rho, to 1e-9, and of their (theta_h, theta_d) rows: a saturated detector makes a plateau. A
// single row may be constant without saturation, as for a BRDF of theta_h and theta_d only, and so
// may more than half of the table, as for a matt material.
struct PlateauSymptom {
  int values = 0, rows = 0, valid = 0;
  bool IsThere() const { return values >= 10 && rows >= 2 && values <= valid / 2; }
};
PlateauSymptom PlateauOf(const BrdfTable& table);

// Fraction of the darker half of the positive signals with another one within 1e-9, in the green
// channel of every third row and one order of the directions: quantised measurements have few
// different values.
struct QuantizationSymptom {
  double share = 0;
  bool IsThere() const { return share > 0.1; }
};
QuantizationSymptom QuantizationOf(const BrdfTable& table);

// Displacement [deg] of the highlight's centre from theta_h = 0 towards wi, and its interquartile
// range: the median over theta_d from 10 to 60 degrees of the centroid of values above half of the
// maximum within theta_h = 15 degrees, where that is three times as bright as the rim. There is a
// highlight if at least ten theta_d have one.
struct TiltSymptom {
  bool highlight = false;
  double degrees = 0, spread = 0;
  bool IsThere() const {
    return (degrees > 0.4 || degrees < -0.4) && 2 * spread < (degrees < 0 ? -degrees : degrees);
  }
};
TiltSymptom TiltOf(const BrdfTable& table);

// The end of a sentence about exchanged directions, for one cosine of theta_i too many or too few.
std::string WhichCosine(bool too_many);

// One sentence per symptom; empty if nothing looks wrong.
std::vector<std::string> SymptomsOf(const BrdfTable& table, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_SYMPTOMS_H_
