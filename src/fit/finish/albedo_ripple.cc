#include "fit/finish/albedo_ripple.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include "core/math/robust_line.h"
#include "fit/prior/albedos_of.h"
#include "trilobe/core/geometry/channels.h"
#include "trilobe/core/math/angles.h"
#include "trilobe/model/axis.h"

namespace trilobe {

AlbedoRipple RippleOf(const FactorModel& model, int num_threads) {
  constexpr double kLast = DegreesToRadians(65), kAround = DegreesToRadians(5);
  AlbedoRipple ripple;
  if (model.spec().anisotropic()) return ripple;
  const Axis& axis = model.spec().g_axis;
  std::vector<double> theta_i;
  for (int k = 0; k < axis.size && axis.Theta(k) <= kLast + kAround; ++k) {
    theta_i.push_back(axis.Theta(k));
  }
  std::vector<double> logs;
  for (const Rgb& albedo : AlbedosOf(model, theta_i, num_threads)) {
    logs.push_back(std::log(albedo[0] + albedo[1] + albedo[2]));
  }
  for (size_t k = 0; k < logs.size() && theta_i[k] <= kLast; ++k) {
    std::vector<double> x, y;
    for (size_t j = 0; j < logs.size(); ++j) {
      if (!(std::abs(theta_i[j] - theta_i[k]) <= kAround) || !std::isfinite(logs[j])) continue;
      x.push_back(theta_i[j]);
      y.push_back(logs[j]);
    }
    if (x.size() < 5 || !std::isfinite(logs[k])) continue;  // no line, or black
    const double off = std::abs(std::expm1(logs[k] - FitRobustLine(x, y)(theta_i[k])));
    if (off > ripple.share) ripple = {.share = off, .theta_i = theta_i[k]};
  }
  return ripple;
}

}  // namespace trilobe
