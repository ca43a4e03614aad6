#include "model/sampling_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "model/cover_spikes.h"
#include "model/max_phi.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

// Nodes of theta_i, denser towards grazing, where lobes change most. Of an isotropic model, each
// entry of G there, if these are a degree apart.
HalfVectorNodes NodesOf(const ModelSpec& spec) {
  HalfVectorNodes nodes;
  const bool anisotropic = spec.anisotropic();
  nodes.y = NodesOfY(spec);
  if (spec.stretches.any()) {
    // Nodes that a narrow highlight of an albedo needs are too many to draw by: every second.
    std::vector<double>& y = nodes.y;
    for (size_t k = 0; 2 * k < y.size(); ++k) y[k] = y[2 * k];
    y.resize((y.size() + 1) / 2);
  }
  nodes.s = anisotropic || spec.stretches.any() ? 33 : 17;
  nodes.phi_i = anisotropic ? std::max({spec.d_axis.phi_nodes, spec.g_axis.phi_nodes, 12}) : 1;
  if (anisotropic) {
    constexpr int kRings = 16;
    for (int k = 0; k < kRings; ++k) {
      const double left = 1 - static_cast<double>(k) / (kRings - 1);
      nodes.theta_i.push_back(kGrazingTheta * (1 - left * left));
    }
  } else {
    constexpr int kEven = 30;
    constexpr double kFirst = 72.5, kLast = 88.5;  // [degrees]
    for (int k = 0; k < kEven; ++k) nodes.theta_i.push_back(DegreesToRadians(kFirst * k / kEven));
    for (double x = kFirst; x <= kLast; ++x) nodes.theta_i.push_back(DegreesToRadians(x));
    nodes.theta_i.push_back(kGrazingTheta);
  }
  return nodes;
}

// Upper bound on the values of the table.
double BoundOf(const FactorModel& model) {
  const double least_cosine = std::cos(kGrazingTheta);
  std::array<double, 3> largest{};
  for (const Factor factor : kFactors) {
    for (int t = 0; t < model.spec().num_tables(factor); ++t) {
      double& x = largest[static_cast<size_t>(factor)];
      x = std::max(x, std::ranges::max(model.table(factor, t)));
    }
  }
  double sum = 0;
  for (int m = 0; m < model.spec().lobes; ++m) sum += std::ranges::max(model.s(m));
  // A spline through G is above its largest entry by an eighth of the largest step at most.
  const double G = 1.125 * largest[static_cast<size_t>(Factor::kG)];
  const double value = sum * largest[static_cast<size_t>(Factor::kD)] *
                       largest[static_cast<size_t>(Factor::kF)] * G * G /
                       (least_cosine * least_cosine);
  return value * 4 * kPi / least_cosine;
}

}  // namespace

template <typename Real>
SamplingTable<Real>::SamplingTable(const FactorModel& model) : model_(model) {
  const auto d = model.d();
  diffuse_albedo_ = static_cast<Real>(Mean(Rgb{d[0], d[1], d[2]}) * kPi);
  constexpr double kLargest = std::numeric_limits<float>::max();
  if (!(diffuse_albedo_ <= kLargest) || !(BoundOf(model) <= kLargest)) {
    throw Error(ErrorKind::kData, "the model's values overflow; its factors are too large")
        .About("model", "overflow");
  }
}

template <typename Real>
HalfVectorTable<Real> SamplingTable<Real>::Make(const PreparedModel<Real>& prepared) const {
  HalfVectorNodes nodes = NodesOf(model_.spec());
  std::vector<float> values = TabulatedLobes(prepared, nodes);
  // Nodes of s are added while covering spikes would cost too much light.
  while (!prepared.anisotropic() && !CoverSpikes(model_, diffuse_albedo_, nodes, &values) &&
         4 * nodes.s - 3 <= HalfVectorTable<Real>::kMaxS) {
    nodes.s = 4 * nodes.s - 3;
    values = TabulatedLobes(prepared, nodes);
  }
  return HalfVectorTable<Real>(nodes, values);
}

// Over y and s, the density of wo by solid angle is multiplied by
//   d omega_o = 4 (wi . h) d omega_h,  cos theta_h d omega_h = dy d phi / 2,  d phi = 2 phi_max ds:
// s goes once through [-phi_max, phi_max], or through both halves of it, which are alike where the
// material is isotropic.
template <typename Real>
std::vector<float> SamplingTable<Real>::TabulatedLobes(const PreparedModel<Real>& prepared,
                                                       const HalfVectorNodes& nodes) const {
  const bool anisotropic = prepared.anisotropic();
  std::vector<float> values;
  values.reserve(nodes.theta_i.size() * nodes.phi_i * nodes.y.size() * nodes.s);
  const double least_cosine = std::cos(kGrazingTheta);
  std::vector<Colour> lobes(std::max(prepared.lobes(), 1));
  for (const double theta_i : nodes.theta_i) {
    const double cos_i = std::cos(theta_i), sin_i = std::sin(theta_i);
    for (int p = 0; p < nodes.phi_i; ++p) {
      const double phi_i = 2 * kPi * p / nodes.phi_i;
      const Vector wi = {static_cast<Real>(sin_i * std::cos(phi_i)),
                         static_cast<Real>(sin_i * std::sin(phi_i)), static_cast<Real>(cos_i)};
      for (size_t row = 0; row < nodes.y.size(); ++row) {
        const double cos_h = std::sqrt(1 - nodes.y[row]), sin_h = std::sqrt(nodes.y[row]);
        const double phi_max = MaxPhi(cos_i, sin_i, cos_h, sin_h);
        for (int k = 0; k < nodes.s; ++k) {
          const double s = static_cast<double>(k) / (nodes.s - 1);
          const double phi = (anisotropic ? 2 * s - 1 : s) * phi_max;
          const double wi_h = cos_i * cos_h + sin_i * sin_h * std::cos(phi);
          const double phi_h = phi_i + phi;
          const double h[] = {sin_h * std::cos(phi_h), sin_h * std::sin(phi_h), cos_h};
          Vector wo;
          for (int a = 0; a < 3; ++a) wo[a] = static_cast<Real>(2 * wi_h * h[a] - wi[a]);
          wo[2] = std::max(wo[2], static_cast<Real>(least_cosine));
          const double scale =
              phi_max > 0 ? wo[2] * 4 * wi_h * phi_max / std::max(cos_h, least_cosine) : 0;
          prepared.LobeValues(wi, wo, lobes.data());
          std::array<double, kChannels> value{};
          for (int m = 0; m < prepared.lobes(); ++m) {
            for (int c = 0; c < kChannels; ++c) value[c] += lobes[m][c] * scale;
          }
          for (double& x : value) x = std::max(x, 0.0);
          values.push_back(static_cast<float>(Mean(value)));
        }
      }
    }
  }
  return values;
}

template class SamplingTable<double>;
template class SamplingTable<float>;

}  // namespace trilobe
