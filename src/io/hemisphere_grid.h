#ifndef TRILOBE_IO_HEMISPHERE_GRID_H_
#define TRILOBE_IO_HEMISPHERE_GRID_H_

#include <optional>
#include <string_view>

#include "trilobe/brdf/channels.h"
#include "trilobe/io/measurement.h"

namespace trilobe {

// Directions above a sample at equal steps: node phis * a + b has theta = 90 a / thetas and
// phi = 360 b / phis degrees. So the horizon is no node, and the normal is one for each phi. The
// default is the grid of the UTIA BRDF database: 15 and 7.5 degrees (Filip and Vavra 2014).
struct HemisphereGrid {
  int thetas = 6;
  int phis = 48;

  constexpr int nodes() const { return thetas * phis; }
  double Theta(int node) const {
    const int a = node / phis;
    return a * (kPi / 2 / thetas);
  }
  double Phi(int node) const { return (node % phis) * (2 * kPi / phis); }
  SphericalAngles Angles(int i, int o) const { return {Theta(i), Phi(i), Theta(o), Phi(o)}; }

  // The node at these angles [rad], to 1e-6; phi is taken modulo 2 pi.
  std::optional<int> Find(double theta, double phi) const;

  bool operator==(const HemisphereGrid&) const = default;
};

// "18x72": 18 theta and 72 phi. Throws Error for anything else, and for grids of more than ten
// million pairs of directions.
HemisphereGrid ParseHemisphereGrid(std::string_view text);

// A measurement of anything at all pairs of nodes of a grid. Where a table or a function was not
// measured, or has no value, the sample is missing. Scattered samples must stand at nodes, one at
// each pair at most; throws Error where they do not. Azimuths matter, whatever the material.
Measurement AtNodes(const Measurement& measurement, const HemisphereGrid& grid, int num_threads);

// [nodes()][nodes()], incidence first: the values of scattered samples at their nodes, and where
// there are any. Throws Error as above.
struct NodeValues {
  std::vector<Rgb> rho;
  std::vector<bool> present;
};
NodeValues ValuesAtNodes(const Measurement& scattered, const HemisphereGrid& grid);

}  // namespace trilobe

#endif  // TRILOBE_IO_HEMISPHERE_GRID_H_
