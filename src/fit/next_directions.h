#ifndef TRILOBE_FIT_NEXT_DIRECTIONS_H_
#define TRILOBE_FIT_NEXT_DIRECTIONS_H_

#include <optional>
#include <string_view>
#include <vector>

#include "model/measurement/directions_to_measure.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/fit/fit_options.h"
#include "trilobe/model/appearance/seen_error.h"
#include "trilobe/model/measurement/measurement.h"

namespace trilobe {

// Fewer samples say too little of a material to choose by a fit to them, and more at once are a
// plan of their own: a fit to those that come first would choose the later ones better.
inline constexpr int kLeastMeasured = 10, kMostNext = 1000;

// How the next directions are chosen. The plan is the default: what the fit says of itself gains
// nothing that is seen in the median of materials (experiments/directions).
enum class NextBy {
  kPlan,    // the plan goes on (DirectionsToMeasure), without those that are measured
  kDesign,  // each tells most of the sphere that is seen, given the fit and all before (SeenDesign)
  kBoth,    // by turns, the first by design: a fit does not know what it does not know
};
const char* NameOf(NextBy by);             // "plan"
NextBy FindNextBy(std::string_view name);  // throws Error, with the names, for another

struct NextDirections {
  std::vector<SphericalAngles> directions;  // in the order in which to measure them
  int measured = 0;                         // samples that were fitted
  // What the fit expects of the whole sphere (FitResult::whole), and its Delta E after these were
  // measured as well: as it falls in the median of materials. Nothing for fewer than 32 samples.
  std::optional<WholeSphere> now = {};
  std::optional<double> expected_delta_e = {};
};

// Which directions to measure next of an isotropic material, of which scattered samples are there.
// None is among these; none at all if the fit was stopped. The first ones of more are those of
// fewer. The same bits for any number of threads. Throws Error unless count is from 1 to kMostNext
// and the device reaches so many more, for a table, for anisotropic samples and for fewer than
// kLeastMeasured, and as Fit.
NextDirections NextDirectionsToMeasure(const Measurement& measurement, int count, NextBy by,
                                       const Goniometer& device, const FitOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_NEXT_DIRECTIONS_H_
