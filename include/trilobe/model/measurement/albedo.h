#ifndef TRILOBE_MODEL_MEASUREMENT_ALBEDO_H_
#define TRILOBE_MODEL_MEASUREMENT_ALBEDO_H_

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/geometry/directions.h"

namespace trilobe {

// BRDF [1/sr] of an isotropic material.
using BrdfFunction = std::function<Rgb(const DirectionPair&)>;

// Directional albedo, the share of the light from theta_i that is reflected:
//   integral of rho(wi, wo) cos theta_o over the hemisphere of wo.
// The integral is taken over half vectors, d omega_o = 4 (wi . h) d omega_h, up to the curve in the
// sphere of h where wo meets the horizon, by Gauss-Legendre rules in the MERL bins of theta_h. So a
// highlight is resolved however narrow it is, as far as MERL bins resolve it. Within 1e-3 for
// smooth materials up to theta_i = 89.5 degrees. theta_i is in [0, pi/2) [rad];
// throws Error elsewhere.
Rgb DirectionalAlbedo(const BrdfFunction& brdf, double theta_i);

// The same for many angles. [theta_i.size()]
std::vector<Rgb> DirectionalAlbedos(const BrdfFunction& brdf, std::span<const double> theta_i,
                                    int num_threads);

// Where the albedo of a channel first passes 1, so that the material would reflect more light than
// it gets: linear between the given angles [rad]; nothing if it stays below. Throws
// Error unless there are as many albedos as angles.
std::optional<double> AlbedoPassesOne(std::span<const double> theta_i, std::span<const Rgb> albedo,
                                      int channel);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_ALBEDO_H_
