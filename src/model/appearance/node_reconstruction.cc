#include "model/appearance/node_reconstruction.h"

#include <algorithm>
#include <cmath>

#include "trilobe/core/base/error.h"
#include "trilobe/model/appearance/material.h"

namespace trilobe {

Measurement ReconstructAtNodes(const FactorModel& model, const std::string& source,
                               const HemisphereGrid& grid) {
  CheckHemisphereGrid(grid);
  const SphericalBrdf brdf = MaterialOf(model).spherical;
  SampleCollector collector(source, "reconstruction of an anisotropic model");
  for (int i = 0; i < grid.nodes(); ++i) {
    for (int o = 0; o < grid.nodes(); ++o) {
      const SphericalAngles at = grid.Angles(i, o);
      Rgb rho = brdf(at);
      for (double& x : rho) {
        if (!std::isfinite(x)) {
          throw Error(source + ": the model's value overflows at nodes " + std::to_string(i) +
                      " and " + std::to_string(o) + "; its factors are too large");
        }
        x = std::max(x, 0.0);
      }
      collector.Add(at, rho);
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = true;
  return measurement;
}

}  // namespace trilobe
