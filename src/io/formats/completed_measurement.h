#ifndef TRILOBE_IO_FORMATS_COMPLETED_MEASUREMENT_H_
#define TRILOBE_IO_FORMATS_COMPLETED_MEASUREMENT_H_

#include <functional>
#include <memory>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {

// BRDF [1/sr] of two directions above the surface.
using PairBrdf = std::function<Rgb(const DirectionPair&)>;

// A measurement as a function of all directions, interpolated with a model m fitted to it:
//   (m + e) q - e,  q interpolated from q = (measured + e) / (m + e) at the places of the data
// (the centres of a table's bins, the nodes of a grid); e is a hundredth of the mean value. It
// equals the measured values at these places and follows the model between them, also in highlights
// narrower than a bin. Where nothing was measured, q is 1 and it equals the model. For scattered
// samples on no grid it is the model.
struct CompletedMeasurement {
  PairBrdf value;
  bool interpolated = true;  // false: `value` is the model
  double offset = 0;         // e [1/sr]
  // q over the bins of a table or over the nodes of a grid. One of them is set if interpolated.
  std::shared_ptr<const TabulatedBrdf> over_table = nullptr;
  std::shared_ptr<const NodeBrdf> over_nodes = nullptr;

  // Places with measured values that are not black, distributed by the cosines of both directions.
  // For measuring the error of an approximation of `value`.
  struct Place {
    DirectionPair at;
    Rgb measured{};
  };
  std::vector<Place> places;
};
// Does not refer to its arguments afterwards. Throws Error for an anisotropic model of a table.
CompletedMeasurement Complete(const Measurement& measurement, const FactorModel& model,
                              int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_COMPLETED_MEASUREMENT_H_
