#ifndef TRILOBE_MODEL_MEASUREMENT_ALBEDO_H_
#define TRILOBE_MODEL_MEASUREMENT_ALBEDO_H_

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "trilobe/core/base/channels.h"
#include "trilobe/core/base/directions.h"

namespace trilobe {

// BRDF [1/sr] of an isotropic material.
using BrdfFunction = std::function<Rgb(const DirectionPair&)>;

// Directional albedo, the reflected share of the light from theta_i:
//   integral of rho(wi, wo) cos theta_o over the hemisphere of wo.
// Integrated over half vectors, d omega_o = 4 (wi . h) d omega_h, up to the curve where wo meets
// the horizon, by Gauss-Legendre rules in the MERL bins of theta_h. So highlights are resolved as
// finely as MERL bins. The error is below 1e-3 for smooth materials up to theta_i = 89.5 degrees.
// Throws Error unless theta_i is in [0, pi/2) [rad].
Rgb DirectionalAlbedo(const BrdfFunction& brdf, double theta_i);

// The same for many angles. [theta_i.size()]
std::vector<Rgb> DirectionalAlbedos(const BrdfFunction& brdf, std::span<const double> theta_i,
                                    int num_threads);

// The angle [rad] at which a channel's albedo first exceeds 1, which violates energy conservation;
// linear between the given angles, nothing if it stays below. Throws Error if the sizes differ.
std::optional<double> AlbedoPassesOne(std::span<const double> theta_i, std::span<const Rgb> albedo,
                                      int channel);

}  // namespace trilobe

#endif  // TRILOBE_MODEL_MEASUREMENT_ALBEDO_H_
