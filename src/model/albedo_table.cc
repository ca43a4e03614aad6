#include "model/albedo_table.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "model/max_phi.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/half_vector_table.h"

namespace trilobe {
namespace {

constexpr int kSteps = 96;  // of s

// Nodes of y, as many again between them where tables are coarse.
std::vector<double> FineNodesOfY(const ModelSpec& spec) {
  const size_t enough = spec.anisotropic() ? 80 : 150;
  std::vector<double> y = NodesOfY(spec);
  while (y.size() < enough) {
    std::vector<double> finer = {y[0]};
    for (size_t k = 1; k < y.size(); ++k) finer.insert(finer.end(), {(y[k - 1] + y[k]) / 2, y[k]});
    y = finer;
  }
  return y;
}

}  // namespace

template <typename Real>
AlbedoTable<Real>::AlbedoTable(const ModelSpec& spec)
    : anisotropic_(spec.anisotropic()),
      rings_(anisotropic_ ? 45 : std::clamp(4 * spec.g_axis.size, 60, 360) - 1),
      azimuths_(anisotropic_ ? std::max({spec.d_axis.phi_nodes, spec.g_axis.phi_nodes, 12}) : 1),
      y_(FineNodesOfY(spec)) {}

template <typename Real>
double AlbedoTable<Real>::RingOf(double theta) const {
  const double part = std::min(theta / kGrazingTheta, 1.0);
  return (anisotropic_ ? 1 - std::sqrt(1 - part) : part) * (rings_ - 1);
}

template <typename Real>
double AlbedoTable<Real>::ThetaOf(int ring) const {
  const double x = static_cast<double>(ring) / (rings_ - 1);
  return kGrazingTheta * (anisotropic_ ? x * (2 - x) : x);
}

template <typename Real>
typename AlbedoTable<Real>::Colour AlbedoTable<Real>::At(const PreparedModel<Real>& model,
                                                         Real theta, Real phi) {
  std::call_once(made_, [&] {
    for (int ring = 0; ring < rings_; ++ring) {
      for (int k = 0; k < azimuths_; ++k) {
        values_.push_back(Integrate(model, ThetaOf(ring), 2 * kPi * k / azimuths_));
      }
    }
  });
  const double x = RingOf(static_cast<double>(theta));
  const int ring = std::min(static_cast<int>(x), rings_ - 2);
  const double turns = static_cast<double>(phi) / (2 * kPi);
  const double a = (turns - std::floor(turns)) * azimuths_;
  const int azimuth = std::min(static_cast<int>(a), azimuths_ - 1);
  const double begin = ThetaOf(ring), end = ThetaOf(ring + 1);
  const double t = std::clamp((static_cast<double>(theta) - begin) / (end - begin), 0.0, 1.0);
  const double u = azimuths_ > 1 ? a - azimuth : 0;
  Colour albedo;
  for (int c = 0; c < kChannels; ++c) {
    const auto between = [&](int r) {
      return (1 - u) * Node(r, azimuth)[c] + u * Node(r, azimuth + 1)[c];
    };
    albedo[c] = static_cast<Real>((1 - t) * between(ring) + t * between(ring + 1));
  }
  return albedo;
}

// The integral of f cos theta_o over y = sin^2 theta_h and s, the azimuth of h from that of wi as a
// fraction of the largest one (bsdf.h):
//   d omega_o = 4 (wi . h) d omega_h,  cos theta_h d omega_h = dy d phi / 2.
// s goes over one half of the circle, or of an anisotropic model over both. By trapezoids of y, in
// whose nodes D has its entries, and the middles of even cells of s.
template <typename Real>
typename AlbedoTable<Real>::Albedo AlbedoTable<Real>::Integrate(const PreparedModel<Real>& model,
                                                                double theta, double phi_i) const {
  const double cos_i = std::cos(theta), sin_i = std::sin(theta);
  const double cos_phi = std::cos(phi_i), sin_phi = std::sin(phi_i);
  // Towards grazing a highlight is narrow in s.
  const int steps = theta < DegreesToRadians(70) ? kSteps / 3 : kSteps;
  std::array<Vector, kSteps> wi, wo;
  wi.fill({static_cast<Real>(sin_i * cos_phi), static_cast<Real>(sin_i * sin_phi),
           static_cast<Real>(cos_i)});
  std::array<Colour, kSteps> f;
  std::array<double, kSteps> scale;
  Albedo sum{}, before{};
  for (size_t row = 0; row < y_.size(); ++row) {
    const double cos_h = std::sqrt(1 - y_[row]), sin_h = std::sqrt(y_[row]);
    const double phi_max = MaxPhi(cos_i, sin_i, cos_h, sin_h);
    Albedo of_row{};
    for (int k = 0; k < steps; ++k) {
      const double s = (k + 0.5) / steps, phi = (anisotropic_ ? 2 * s - 1 : s) * phi_max;
      const double wi_h = cos_i * cos_h + sin_i * sin_h * std::cos(phi);
      const double along = 2 * wi_h * sin_h * std::cos(phi) - sin_i;
      const double across = 2 * wi_h * sin_h * std::sin(phi);
      wo[k] = {static_cast<Real>(along * cos_phi - across * sin_phi),
               static_cast<Real>(along * sin_phi + across * cos_phi),
               static_cast<Real>(2 * wi_h * cos_h - cos_i)};
      scale[k] = std::max<double>(wo[k][2], 0) * 4 * wi_h * phi_max / std::max(cos_h, 1e-9);
    }
    const auto first = [steps](const auto& all) { return std::span(all).first(steps); };
    model.Values(first(wi), first(wo), std::span(f).first(steps));
    for (int k = 0; k < steps; ++k) {
      if (!(wo[k][2] > 0)) continue;
      for (int c = 0; c < kChannels; ++c) {
        // The diffuse term has an integral of its own.
        of_row[c] += (f[k][c] - model.diffuse()[c]) * scale[k] / steps;
      }
    }
    for (int c = 0; row > 0 && c < kChannels; ++c) {
      sum[c] += (before[c] + of_row[c]) / 2 * (y_[row] - y_[row - 1]);
    }
    before = of_row;
  }
  for (int c = 0; c < kChannels; ++c) sum[c] = std::max(sum[c] + kPi * model.diffuse()[c], 0.0);
  return sum;
}

template class AlbedoTable<double>;
template class AlbedoTable<float>;

}  // namespace trilobe
