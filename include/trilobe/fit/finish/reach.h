#ifndef TRILOBE_FIT_FINISH_REACH_H_
#define TRILOBE_FIT_FINISH_REACH_H_

#include <cstddef>
#include <vector>

#include "trilobe/core/base/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"

// Values of a model between and beyond scattered samples.
namespace trilobe {

// Distribution of pairs of directions. kByHighlights: half vectors even in the square root of
// theta_h. kRetroreflectionToo: every other half vector is even in theta_h instead, which adds
// pairs near retroreflection at grazing angles.
enum class Spread { kByHighlights, kRetroreflectionToo };

// Pairs of directions, both at most `max_theta` from the normal [rad], by Halton's sequence.
// [count, or fewer if max_theta is near 0]
std::vector<SphericalAngles> DirectionsBetween(double max_theta, size_t count, Spread spread);

double LargestTheta(const BrdfSamples& samples);  // of theta_i and theta_o [rad]
double LargestValue(const BrdfSamples& samples);  // of all channels [1/sr]

// Those of 50,000 pairs of directions up to max_theta where a channel of the model exceeds `value`.
// The same for any number of threads.
std::vector<SphericalAngles> DirectionsAbove(double value, double max_theta,
                                             const FactorModel& model, int num_threads);

// Largest value of a model over the largest measured value: `between` for pairs of directions up to
// max_theta, `beyond` for pairs with one direction farther, up to 89 degrees. 0 if there are no
// such pairs or the samples are black.
struct Reach {
  double max_theta = 0;  // of the samples [rad]
  double between = 0, beyond = 0;
};
Reach ReachOf(const BrdfSamples& samples, const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_FINISH_REACH_H_
