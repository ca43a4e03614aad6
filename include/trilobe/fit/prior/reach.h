#ifndef TRILOBE_FIT_PRIOR_REACH_H_
#define TRILOBE_FIT_PRIOR_REACH_H_

#include <cstddef>
#include <vector>

#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"

// How large a model is where scattered samples do not say so.
namespace trilobe {

// Pairs of directions up to theta, with half vectors spaced as a highlight asks for, by the root of
// theta_h; or every other one about a half vector spread evenly in theta_h, so that there are
// enough of retroreflection near the horizon, too, where hardly any of the former are.
enum class Spread { kByHighlights, kRetroreflectionToo };

// So many pairs of directions, both at most `max_theta` from the normal [rad], by Halton's
// sequence. [count, or fewer where the angle is next to 0]
std::vector<SphericalAngles> DirectionsBetween(double max_theta, size_t count, Spread spread);

double LargestTheta(const BrdfSamples& samples);  // of theta_i and theta_o [rad]
double LargestValue(const BrdfSamples& samples);  // of all channels [1/sr]

// Those of 50,000 pairs of directions up to max_theta where a channel of the model is larger than
// `value`. The same for any number of threads.
std::vector<SphericalAngles> DirectionsAbove(double value, double max_theta,
                                             const FactorModel& model, int num_threads);

// The largest values of a model over the largest that was measured, among pairs of directions as
// far from the normal as the samples, and among pairs of which one is farther; there up to 89
// degrees. 0 where there are no such pairs, or the samples are black.
struct Reach {
  double max_theta = 0;  // of the samples [rad]
  double between = 0, beyond = 0;
};
Reach ReachOf(const BrdfSamples& samples, const FactorModel& model, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRIOR_REACH_H_
