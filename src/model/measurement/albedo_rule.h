#ifndef TRILOBE_MODEL_MEASUREMENT_ALBEDO_RULE_H_
#define TRILOBE_MODEL_MEASUREMENT_ALBEDO_RULE_H_

#include <array>
#include <cmath>
#include <vector>

#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/merl_grid.h"

namespace trilobe {

// Half planes through the normal, in which DirectionalAlbedo integrates.
inline constexpr int kAlbedoAzimuths = 180;

// Nodes of two-point Gauss-Legendre rules in the MERL bins of theta_h, the same for all half planes
// but in the last bin.
struct HalfAngleNodes {
  struct Node {
    double sin_h, cos_h;
  };
  HalfAngleNodes();

  MerlGrid grid;
  std::vector<double> edges;                // [rad], [grid.theta_h + 1]
  std::vector<std::array<Node, 2>> of_bin;  // [grid.theta_h]
};

// theta_h [rad] of the node `k` of a rule from `from` that is `width` wide.
inline double HalfAngleNode(int k, double from, double width) {
  constexpr double kGaussNodes[] = {0.21132486540518712, 0.78867513459481288};  // on [0, 1]
  return from + kGaussNodes[k] * width;
}

inline HalfAngleNodes::HalfAngleNodes() {
  for (int bin = 0; bin <= grid.theta_h; ++bin) edges.push_back(grid.ThetaH(bin));
  for (int bin = 0; bin < grid.theta_h; ++bin) {
    std::array<Node, 2> nodes{};
    for (int k = 0; k < 2; ++k) {
      const double theta_h = HalfAngleNode(k, edges[bin], edges[bin + 1] - edges[bin]);
      nodes[k] = {std::sin(theta_h), std::cos(theta_h)};
    }
    of_bin.push_back(nodes);
  }
}

// The rule of DirectionalAlbedo for light from theta_i in the plane of x and z:
//   integral of rho(wi, wo) cos theta_o d omega_o ~ 2 pi / azimuths sum weight rho(pair),
// by two-point Gauss-Legendre rules in the MERL bins of theta_h. Calls visit(pair, weight), for the
// wo on one side of the plane alone if they are mirrored on the other.
enum class Side { kBoth, kOne };
template <typename Visitor>
void VisitReflected(double theta_i, int azimuths, const Visitor& visit, Side side = Side::kBoth) {
  static const HalfAngleNodes all;
  const MerlGrid& grid = all.grid;
  const Direction wi{std::sin(theta_i), 0, std::cos(theta_i)};
  for (int k = 0; k < (side == Side::kOne ? azimuths / 2 : azimuths); ++k) {
    const double phi = (k + 0.5) / azimuths * 2 * kPi;
    const double cos_phi = std::cos(phi), sin_phi = std::sin(phi);
    // With psi = atan2(sin theta_i cos phi, cos theta_i), cos theta_o is proportional to
    // cos(2 theta_h - psi), and wi . h to cos(theta_h - psi).
    const double psi = std::atan2(wi[0] * cos_phi, wi[2]);
    const double end = (psi + kPi / 2) / 2;
    for (int bin = 0; bin < grid.theta_h && all.edges[bin] < end; ++bin) {
      const double from = all.edges[bin];
      const bool is_whole = all.edges[bin + 1] <= end;
      const double width = (is_whole ? all.edges[bin + 1] : end) - from;
      for (int node = 0; node < 2; ++node) {
        double sin_h = all.of_bin[bin][node].sin_h, cos_h = all.of_bin[bin][node].cos_h;
        if (!is_whole) {
          const double theta_h = HalfAngleNode(node, from, width);
          sin_h = std::sin(theta_h);
          cos_h = std::cos(theta_h);
        }
        const Direction h{sin_h * cos_phi, sin_h * sin_phi, cos_h};
        const double wi_dot_h = wi[0] * h[0] + wi[2] * h[2];
        const Direction wo{2 * wi_dot_h * h[0] - wi[0], 2 * wi_dot_h * h[1],
                           2 * wi_dot_h * h[2] - wi[2]};
        if (!(wo[2] > 0)) continue;  // rounding, at the very horizon
        visit(DirectionPair{wi, wo}, wo[2] * 4 * wi_dot_h * sin_h * width / 2);
      }
    }
  }
}

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_ALBEDO_RULE_H_
