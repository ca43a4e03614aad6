#ifndef TRILOBE_MODEL_OBJECTIVE_WEIGHTING_H_
#define TRILOBE_MODEL_OBJECTIVE_WEIGHTING_H_

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"

namespace trilobe {

struct BrdfSamples;

// What the weight of a measured sample may depend on.
struct WeightedPoint {
  Rgb rho{};               // measured BRDF [1/sr], finite and >= 0
  Cosines cosines;         // of theta_i and theta_o, in (0, 1]
  double solid_angle = 1;  // of the directions that the sample stands for, in any unit
};

// A named choice of the weights w of E = sum w (rho - rho*)^2 (docs/objective.md). A weight depends
// on one measured sample and, at most, on the mean level of the measurement that it belongs to.
struct Weighting {
  std::string name;
  std::string description;  // one line: formula and source
  // The fit to a measurement multiplied by 2^k is 2^k times the fit to the measurement.
  bool scale_free = false;
  // Of a point and `level`; finite and >= 0.
  std::function<Rgb(const WeightedPoint&, double level)> formula = nullptr;
  // Where the formula asks for it: MeanReflectance of the measurement [1/sr], once it is known.
  bool needs_level = false;
  double level = 0;

  Rgb operator()(const WeightedPoint& point) const { return formula(point, level); }
};

// All that have a name of their own, the default one first. Besides, FindWeighting knows
// "power:KEY=VALUE,...", see there.
const std::vector<Weighting>& Weightings();

// One of the above by its name, or
//   power:exponent=P,epsilon=E,relative=0|1,by_channel=0|1,both_cosines=0|1,solid_angle=A
// for w = W^A (c (c rho* + E)^-P)^2: the squared tangent of (b + E)^(1 - P) or, where P = 1, of
// log(b + E), at b = c rho*. There c is cos theta_i, or cos theta_i cos theta_o with both_cosines;
// rho* is the mean over the channels unless by_channel; rho* is taken in units of the level where
// relative; and W is the solid angle of a bin. What is left out is 1, 1e-3, 0, 0, 0, 0.
// Throws Error that lists what is known.
Weighting FindWeighting(std::string_view name);

// The same with the level of these samples, unless it has one already: copies that see fewer
// samples keep the level of the whole. Throws Error if the weighting has no formula.
Weighting ForSamples(Weighting weighting, const BrdfSamples& samples, int num_threads = 1);

// The BRDF of a Lambertian material that reflects as much light as the samples do, all channels and
// all directions taken together [1/sr]: the mean of rho* over all samples, weighted by
// cos theta_i cos theta_o and solid angle; multiplicities do not count. 0 for a black measurement.
// The same bits for any number of threads.
double MeanReflectance(const BrdfSamples& samples, int num_threads = 1);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_OBJECTIVE_WEIGHTING_H_
