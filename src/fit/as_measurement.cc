#include "trilobe/fit/as_measurement.h"

#include "model/appearance/node_appearance.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {

Measurement AsMeasurement(const FactorModel& model, const std::string& source, int num_threads,
                          const HemisphereGrid& grid) {
  if (model.spec().anisotropic()) return ReconstructAtNodes(model, source, grid);
  return {.source = source,
          .kind = "reconstruction",
          .table = Reconstruct(model, source, {}, num_threads)};
}

}  // namespace trilobe
