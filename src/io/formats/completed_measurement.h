#ifndef TRILOBE_IO_FORMATS_COMPLETED_MEASUREMENT_H_
#define TRILOBE_IO_FORMATS_COMPLETED_MEASUREMENT_H_

#include <functional>
#include <memory>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/measurement/tabulated_brdf.h"

namespace trilobe {

// BRDF [1/sr] of two directions above the surface.
using PairBrdf = std::function<Rgb(const DirectionPair&)>;

// A measurement as a function of all directions, by help of a model m fitted to it: between the
// places of the data (the centres of a table's bins, the nodes of a grid) it is
//   (m + e) q - e,  q interpolated from q = (measured + e) / (m + e) at these places,
// e a hundredth of the mean value. So at the places it is what was measured; between them it bends
// as the model does, highlights narrower than a bin included; and where nothing was measured, q is
// 1 and it is the model.
// Scattered samples that stand at no grid have nothing to interpolate in: it is the model.
struct CompletedMeasurement {
  PairBrdf value;
  bool interpolated = true;  // false: it is the model
  double offset = 0;         // e [1/sr]
  // q over the bins of a table, or over the nodes of a grid; one of them, where it is interpolated.
  std::shared_ptr<const TabulatedBrdf> over_table = nullptr;
  std::shared_ptr<const NodeBrdf> over_nodes = nullptr;

  // Measured places, distributed by the cosines of both directions as far as they go, to judge
  // whatever is to say the same, with what was measured there, not black.
  struct Place {
    DirectionPair at;
    Rgb measured{};
  };
  std::vector<Place> places;
};
// Copies what it needs. Throws Error for an anisotropic model of a table.
CompletedMeasurement Complete(const Measurement& measurement, const FactorModel& model,
                              int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_IO_FORMATS_COMPLETED_MEASUREMENT_H_
