#ifndef TRILOBE_EXPERIMENTS_STIFF_MATERIAL_H_
#define TRILOBE_EXPERIMENTS_STIFF_MATERIAL_H_

#include <cmath>
#include <utility>

#include "experiments/stiff/cases.h"
#include "tests/test_util.h"

namespace trilobe {

// Parameters that the materials of all cases share: d, F0 of Fresnel's factor by channel, s by
// lobe, and the standard deviation of the logarithms by which the entries of tables jitter.
inline constexpr Rgb kDiffuse = {0.05, 0.08, 0.11};
inline constexpr double kF0[kChannels] = {0.9, 0.5, 0.3};
inline constexpr Rgb kWeight[] = {{0.3, 0.25, 0.2}, {0.4, 0.2, 0.5}, {0.2, 0.6, 0.7}};
inline constexpr double kJitter = 0.1;

inline double Schlick(double theta_d, double f0) {
  return f0 + (1 - f0) * std::pow(1 - std::cos(theta_d), 5);
}

inline double Shadowing(double theta, double strength) {
  return 1 / (1 + strength * std::tan(theta) * std::tan(theta) / 10);
}

template <typename Change>  // double(double)
StiffProblem Changed(StiffProblem problem, Change change) {
  for (Rgb& rho : problem.samples.rho) {
    for (double& value : rho) value = change(value);
  }
  return problem;
}

// Log-normal, of this relative standard deviation and mean 1.
inline StiffProblem Noisy(StiffProblem problem, double noise) {
  Random random(2);
  const double sigma = std::sqrt(std::log1p(noise * noise));
  return Changed(std::move(problem), [&](double rho) {
    return rho * random.LogNormal(sigma) * std::exp(-sigma * sigma / 2);
  });
}

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_STIFF_MATERIAL_H_
