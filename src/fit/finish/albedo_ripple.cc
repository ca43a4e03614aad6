#include "fit/finish/albedo_ripple.h"

#include <cmath>
#include <cstdlib>
#include <vector>

#include "fit/finish/albedos_of.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/channels.h"

namespace trilobe {
namespace {

// Weight of the value at place j, from -m to m, in the middle of the parabola fitted to them.
double WeightInParabola(int j, int m) {
  return 3.0 * (3 * m * m + 3 * m - 1 - 5 * j * j) / ((2 * m - 1) * (2 * m + 1) * (2 * m + 3));
}

}  // namespace

AlbedoRipple RippleOf(const FactorModel& model, int num_threads) {
  constexpr int kPerDegree = 2, kLast = 65 * kPerDegree, kAround = 2 * kPerDegree;
  AlbedoRipple ripple;
  if (model.spec().anisotropic()) return ripple;
  std::vector<double> theta_i;
  for (int k = 0; k <= kLast + kAround; ++k) {
    theta_i.push_back(DegreesToRadians(static_cast<double>(k) / kPerDegree));
  }
  std::vector<double> logs;
  for (const Rgb& albedo : AlbedosOf(model, theta_i, num_threads)) {
    logs.push_back(std::log(albedo[0] + albedo[1] + albedo[2]));
  }
  for (int k = 0; k <= kLast; ++k) {
    double course = 0;  // an albedo is even in theta_i
    for (int j = -kAround; j <= kAround; ++j) {
      course += WeightInParabola(j, kAround) * logs[std::abs(k + j)];
    }
    const double off = std::abs(std::expm1(logs[k] - course));  // NaN where it is black
    if (off > ripple.share) ripple = {.share = off, .theta_i = theta_i[k]};
  }
  return ripple;
}

}  // namespace trilobe
