#include "trilobe/model/weighting.h"

#include <cmath>

#include "trilobe/base/named.h"

namespace trilobe {
namespace {

// Squared chord of log(1 + b), b = rho cos_i, from 0: (log(1+b)/rho)^2, which tends to cos_i^2.
double CompressiveWeight(double rho_star, double cos_i) {
  const double b = rho_star * cos_i;
  // log(1+b)/b, by its series where b may have lost digits to underflow.
  const double chord = b < 1e-9 ? 1 - b / 2 : std::log1p(b) / b;
  return chord * cos_i * (chord * cos_i);
}

// Squared slope of log(1 + rho cos_i).
double LogWeight(double rho_star, double cos_i) {
  const double slope = cos_i / (1 + rho_star * cos_i);
  return slope * slope;
}

double PercentageWeight(double rho_star, double /*cos_i*/) {
  const double inverse = 1 / (rho_star + 1e-3);
  return inverse * inverse;
}

double CosineWeight(double /*rho_star*/, double cos_i) { return cos_i * cos_i; }

double UniformWeight(double /*rho_star*/, double /*cos_i*/) { return 1; }

}  // namespace

const std::vector<Weighting>& Weightings() {
  static const std::vector<Weighting> weightings = {
      {"compressive", "(log(1+b)/rho)^2, b = rho cos theta_i: the chord of Low's log metric", false,
       CompressiveWeight},
      {"log", "(cos theta_i/(1+b))^2: the tangent of log(1+b), Low et al. 2012", false, LogWeight},
      {"percentage", "1/(rho+1e-3)^2: relative error, Tofallis 2008", false, PercentageWeight},
      {"cosine", "cos^2 theta_i", true, CosineWeight},
      {"uniform", "1", true, UniformWeight},
  };
  return weightings;
}

const Weighting& FindWeighting(std::string_view name) {
  return FindNamed("weighting", name, Weightings());
}

}  // namespace trilobe
