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
// material is isotropic. Azimuths of a row follow each other by a rotation, and a row is evaluated
// at once: the lobes are its values without the diffuse term.
template <typename Real>
std::vector<float> SamplingTable<Real>::TabulatedLobes(const PreparedModel<Real>& prepared,
                                                       const HalfVectorNodes& nodes) const {
  const bool anisotropic = prepared.anisotropic();
  std::vector<float> values(nodes.theta_i.size() * nodes.phi_i * nodes.y.size() * nodes.s);
  float* row_values = values.data();
  const double least_cosine = std::cos(kGrazingTheta);
  const size_t size = nodes.s;
  std::vector<Vector> in(size), out(size);
  std::vector<Colour> f(size);
  std::vector<double> scale(size);
  for (const double theta_i : nodes.theta_i) {
    const double cos_i = std::cos(theta_i), sin_i = std::sin(theta_i);
    for (int p = 0; p < nodes.phi_i; ++p) {
      const double phi_i = 2 * kPi * p / nodes.phi_i;
      const double cos_phi_i = std::cos(phi_i), sin_phi_i = std::sin(phi_i);
      std::ranges::fill(in, Vector{static_cast<Real>(sin_i * cos_phi_i),
                                   static_cast<Real>(sin_i * sin_phi_i), static_cast<Real>(cos_i)});
      for (size_t row = 0; row < nodes.y.size(); ++row, row_values += size) {
        const double cos_h = std::sqrt(1 - nodes.y[row]), sin_h = std::sqrt(nodes.y[row]);
        const double phi_max = MaxPhi(cos_i, sin_i, cos_h, sin_h);
        if (!(phi_max > 0)) continue;  // no wo is above the surface
        const double first = anisotropic ? -phi_max : 0;
        const double step = (phi_max - first) / static_cast<double>(size - 1);
        const double cos_step = std::cos(step), sin_step = std::sin(step);
        double cos_phi = std::cos(first), sin_phi = std::sin(first);
        for (size_t k = 0; k < size; ++k) {
          const double twice_wi_h = 2 * (cos_i * cos_h + sin_i * sin_h * cos_phi);
          const double along = twice_wi_h * sin_h * cos_phi - sin_i;
          const double across = twice_wi_h * sin_h * sin_phi;
          const double cos_o = std::max(twice_wi_h * cos_h - cos_i, least_cosine);
          out[k] = {static_cast<Real>(along * cos_phi_i - across * sin_phi_i),
                    static_cast<Real>(along * sin_phi_i + across * cos_phi_i),
                    static_cast<Real>(cos_o)};
          scale[k] = cos_o * 2 * twice_wi_h * phi_max / std::max(cos_h, least_cosine);
          const double next = cos_phi * cos_step - sin_phi * sin_step;
          sin_phi = sin_phi * cos_step + cos_phi * sin_step;
          cos_phi = next;
        }
        prepared.Values(in, out, f);
        for (size_t k = 0; k < size; ++k) {
          double sum = 0;
          for (int c = 0; c < kChannels; ++c) {
            sum += std::max(static_cast<double>(f[k][c] - prepared.diffuse()[c]), 0.0);
          }
          row_values[k] = static_cast<float>(sum * std::max(scale[k], 0.0) / kChannels);
        }
      }
    }
  }
  return values;
}

template class SamplingTable<double>;
template class SamplingTable<float>;

}  // namespace trilobe
