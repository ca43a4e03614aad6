#include "model/synth/microcylinder.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trilobe {
namespace {

double Gaussian(double x, double sigma) {
  return std::exp(-x * x / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * kPi));
}

// Of unpolarised light by a dielectric.
double FresnelReflectance(double eta, double cosine) {
  const double inside = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
  const double s = (cosine - eta * inside) / (cosine + eta * inside);
  const double p = (eta * cosine - inside) / (eta * cosine + inside);
  return (s * s + p * p) / 2;
}

// A direction seen from a tangent. On the thread's lit side cos phi and cos psi are positive.
struct ThreadAngles {
  ThreadAngles(const Direction& w, const Direction& t, const Direction& n, const Direction& b)
      : x(Dot(w, t)), y(Dot(w, n)), z(Dot(w, b)) {
    cos_theta = std::hypot(y, z);
    cos_phi = y / cos_theta;
    cos_psi = y / std::hypot(x, y);
    theta = std::atan2(x, cos_theta);
    phi = std::atan2(z, y);
    psi = std::atan2(x, y);
  }
  double x, y, z;
  double cos_theta, cos_phi, cos_psi;
  double theta, phi, psi;
};

// M above.
double Correlated(double difference, double cos_a, double cos_b) {
  constexpr double kSigma = DegreesToRadians(20);
  const double near = std::exp(-difference * difference / (2 * kSigma * kSigma));
  return (1 - near) * cos_a * cos_b + near * std::min(cos_a, cos_b);
}

}  // namespace

MicrocylinderBrdf::MicrocylinderBrdf(const Cloth& cloth) : cloth_(cloth), gap_(1) {
  for (int k = 0; k < static_cast<int>(cloth.size()); ++k) {
    const Thread& thread = cloth[k];
    gap_ -= thread.area;
    const double length = std::accumulate(thread.lengths.begin(), thread.lengths.end(), 0.0);
    for (size_t part = 0; part < thread.lengths.size(); ++part) {
      const double begin = thread.tangent_offsets[part], end = thread.tangent_offsets[part + 1];
      // Steps of half a standard deviation of the narrowest term make a sum smooth.
      const int count =
          std::max(1, static_cast<int>(std::ceil(std::abs(end - begin) / (thread.gamma_s / 2))));
      for (int step = 0; step < count && thread.lengths[part] > 0; ++step) {
        const double offset = DegreesToRadians(begin + (end - begin) * (step + 0.5) / count);
        const double along = std::cos(offset), up = std::sin(offset);
        Tangent tangent{.weight = thread.area * thread.lengths[part] / (length * count),
                        .thread = k};
        tangent.t = k == 0 ? Direction{along, 0, up} : Direction{0, along, up};
        tangent.n = k == 0 ? Direction{-up, 0, along} : Direction{0, -up, along};
        tangent.b = k == 0 ? Direction{0, 1, 0} : Direction{-1, 0, 0};
        tangents_.push_back(tangent);
      }
    }
  }
}

MicrocylinderBrdf::BothOrders MicrocylinderBrdf::Evaluate(const DirectionPair& pair) const {
  const double cos_i = pair.wi[2], cos_o = pair.wo[2];
  BothOrders sums;
  double seen_i = gap_ * cos_i, seen_o = gap_ * cos_o;  // Q of both directions
  for (const Tangent& tangent : tangents_) {
    const Thread& thread = cloth_[tangent.thread];
    const ThreadAngles i(pair.wi, tangent.t, tangent.n, tangent.b);
    const ThreadAngles o(pair.wo, tangent.t, tangent.n, tangent.b);
    if (i.y > 0) seen_i += tangent.weight * i.cos_psi;
    if (o.y > 0) seen_o += tangent.weight * o.cos_psi;
    if (!(i.y > 0 && o.y > 0)) continue;
    const double theta_h = (i.theta + o.theta) / 2, cos_theta_d = std::cos((i.theta - o.theta) / 2);
    const double cos_half_phi = std::cos((i.phi - o.phi) / 2);
    const double surface = FresnelReflectance(thread.eta, cos_theta_d * cos_half_phi) *
                           cos_half_phi * Gaussian(theta_h, DegreesToRadians(thread.gamma_s));
    const double volume =
        (1 - FresnelReflectance(thread.eta, i.y)) * (1 - FresnelReflectance(thread.eta, o.y)) *
        ((1 - thread.k_d) * Gaussian(theta_h, DegreesToRadians(thread.gamma_v)) + thread.k_d) /
        (i.cos_theta + o.cos_theta);
    const double seen = tangent.weight * Correlated(i.phi - o.phi, i.cos_phi, o.cos_phi) *
                        Correlated(i.psi - o.psi, i.cos_psi, o.cos_psi) /
                        (cos_theta_d * cos_theta_d);
    for (int c = 0; c < kChannels; ++c) {
      const double scattered = seen * (surface + volume * thread.color[c]);
      sums.rho[c] += scattered * i.cos_theta;
      sums.exchanged[c] += scattered * o.cos_theta;
    }
  }
  for (int c = 0; c < kChannels; ++c) {
    if (sums.rho[c] > 0) sums.rho[c] /= seen_o * cos_i;
    if (sums.exchanged[c] > 0) sums.exchanged[c] /= seen_i * cos_o;
  }
  return sums;
}

Rgb MicrocylinderBrdf::Published(const DirectionPair& pair) const { return Evaluate(pair).rho; }

Rgb MicrocylinderBrdf::operator()(const DirectionPair& pair) const {
  const auto [rho, exchanged] = Evaluate(pair);
  Rgb mean;
  for (int c = 0; c < kChannels; ++c) mean[c] = std::sqrt(rho[c] * exchanged[c]);
  return mean;
}

}  // namespace trilobe
