#ifndef TRILOBE_MODEL_OBJECTIVE_WEIGHTING_H_
#define TRILOBE_MODEL_OBJECTIVE_WEIGHTING_H_

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

struct BrdfSamples;

// The inputs of a sample's weight.
struct WeightedPoint {
  Rgb rho{};               // measured BRDF [1/sr], finite and >= 0
  Cosines cosines;         // of theta_i and theta_o, in (0, 1]
  double solid_angle = 1;  // of the sample's directions, in any unit
};

// A named choice of the weights w in E = sum w (rho - rho*)^2 (docs/objective.md). A weight depends
// on one measured sample and at most on the mean level of its measurement.
struct Weighting {
  std::string name;
  std::string description;  // one line: formula and source
  // Scaling the measurement by 2^k scales its fit by 2^k.
  bool scale_free = false;
  // The weight of a point at a level; finite and >= 0.
  std::function<Rgb(const WeightedPoint&, double level)> formula = nullptr;
  // Whether the formula uses `level`, MeanReflectance of the measurement [1/sr] (ForSamples sets
  // it).
  bool needs_level = false;
  double level = 0;

  Rgb operator()(const WeightedPoint& point) const { return formula(point, level); }
};

// The weightings with fixed names, the default first. FindWeighting also accepts
// "power:KEY=VALUE,...".
const std::vector<Weighting>& Weightings();

// One of the above by name, or
//   power:exponent=P,epsilon=E,relative=0|1,by_channel=0|1,both_cosines=0|1,solid_angle=A
// for w = W^A (c (c rho* + E)^-P)^2: the squared derivative by rho of (b + E)^(1 - P) up to a
// factor or, if P = 1, of log(b + E), at b = c rho*. c is cos theta_i, times cos theta_o with
// both_cosines; rho* is the mean over the channels unless by_channel, and in units of the level if
// relative; W is the solid angle of a bin. Defaults: 1, 1e-3, 0, 0, 0, 0.
// Throws Error with the known names and keys.
Weighting FindWeighting(std::string_view name);

// The weighting with the level of these samples, unless it already has one: subsets of samples keep
// the level of the whole. Throws Error if the weighting has no formula.
Weighting ForSamples(Weighting weighting, const BrdfSamples& samples, int num_threads = 1);

// The BRDF [1/sr] of a Lambertian material that reflects as much light as the samples, over all
// channels and directions: the mean of rho* weighted by cos theta_i cos theta_o and solid angle,
// without multiplicities. 0 for a black measurement. The same bits for any number of threads.
double MeanReflectance(const BrdfSamples& samples, int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_WEIGHTING_H_
