#include "trilobe/evaluate/bsdf.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trilobe/base/error.h"
#include "trilobe/math/angles.h"

namespace trilobe {
namespace {

// Of wi and wo: beyond, G / cos theta is constant in models whose cosines are splined.
constexpr double kMaxTheta = 89.5 / 180 * kPi;

// Of the half vectors, at least so much is drawn by the cosine, too, lest something that the table
// has no node at is never drawn: of what the lobes reflect.
constexpr double kCosineShare = 0.01;

// The azimuth between the half vector and wo up to which wi is above the surface, for
//   0 < cos theta_i = 2 (wo . h) cos theta_h - cos theta_o. [rad]
template <typename Real>
Real MaxPhi(Real cos_o, Real sin_o, Real cos_h, Real sin_h) {
  const Real denominator = 2 * sin_h * cos_h * sin_o;
  const Real numerator = -cos_o * (2 * cos_h * cos_h - 1);
  if (numerator <= -denominator) return static_cast<Real>(kPi);
  return numerator >= denominator ? Real{0} : std::acos(numerator / denominator);
}

[[noreturn]] void Overflow() {
  throw Error("the model's values overflow; its factors are too large");
}

// Above the surface, and a number.
template <typename Vector>
bool IsAbove(const Vector& w) {
  return w[2] > 0 && std::isfinite(w[0]) && std::isfinite(w[1]) && std::isfinite(w[2]);
}

template <typename Colour>
auto MeanOf(const Colour& colour) {
  return (colour[0] + colour[1] + colour[2]) / 3;
}

// y of the entries of D and some between them; where D is linear between its entries, so is the
// table in y between these, or nearly.
std::vector<double> NodesOfY(const ModelSpec& spec) {
  const Axis& d_axis = spec.d_axis;
  std::vector<double> theta = {0};
  if (d_axis.polar()) {
    constexpr int kSteps = 4;
    std::vector<double> rings = d_axis.theta;
    if (rings.front() > 0) rings.insert(rings.begin(), 0);
    rings.push_back(90);
    for (size_t a = 1; a < rings.size(); ++a) {
      for (int k = 1; k <= kSteps; ++k) {
        const double degrees = rings[a - 1] + (rings[a] - rings[a - 1]) * k / kSteps;
        theta.push_back(DegreesToRadians(degrees));
      }
    }
  } else {
    // Halves of bins of sqrt(theta), less where a stretch makes these narrower.
    const int steps = (spec.stretches.any() ? 4 : 2) * d_axis.size;
    for (int k = 1; k <= steps; ++k) {
      const double x = static_cast<double>(k) / steps;
      theta.push_back(x * x * kPi / 2);
    }
  }
  std::vector<double> y;
  for (const double t : theta) y.push_back(std::sin(t) * std::sin(t));
  y.back() = 1;
  return y;
}

}  // namespace

// theta_o closer together towards grazing, where the lobes change most.
template <typename Real>
struct Bsdf<Real>::Nodes : HalfVectorTable<Real>::Nodes {
  explicit Nodes(const ModelSpec& spec) {
    const bool anisotropic = spec.anisotropic();
    this->y = NodesOfY(spec);
    this->s = anisotropic || spec.stretches.any() ? 33 : 17;
    this->phi_o = anisotropic ? std::max({spec.d_axis.phi_nodes, spec.g_axis.phi_nodes, 12}) : 1;
    const int rings = anisotropic ? 16 : 24;
    for (int k = 0; k < rings; ++k) {
      const double left = 1 - static_cast<double>(k) / (rings - 1);
      this->theta_o.push_back(kMaxTheta * (1 - left * left));
    }
  }
};

template <typename Real>
Bsdf<Real>::Bsdf(const FactorModel& model) : model_(model) {
  diffuse_albedo_ = MeanOf(model_.diffuse()) * static_cast<Real>(kPi);
  if (!(diffuse_albedo_ <= std::numeric_limits<float>::max())) Overflow();
  MakeTables(Nodes(model.spec()));
}

// Over y and s, the density of wi by solid angle is multiplied by
//   d omega_i = 4 (wo . h) d omega_h,  cos theta_h d omega_h = dy d phi / 2,  d phi = 2 phi_max ds:
// s goes once through [-phi_max, phi_max], or through both halves of it, which are alike where the
// material is isotropic.
template <typename Real>
void Bsdf<Real>::MakeTables(const Nodes& nodes) {
  const bool anisotropic = model_.anisotropic();
  std::vector<float> values;
  values.reserve(nodes.theta_o.size() * nodes.phi_o * nodes.y.size() * nodes.s);
  std::vector<std::array<double, kChannels>> albedos;
  const double least_cosine = std::cos(kMaxTheta);
  std::vector<Colour> lobes(std::max(model_.lobes(), 1));
  for (const double theta_o : nodes.theta_o) {
    const double cos_o = std::cos(theta_o), sin_o = std::sin(theta_o);
    for (int p = 0; p < nodes.phi_o; ++p) {
      const double phi_o = 2 * kPi * p / nodes.phi_o;
      const Vector wo = {static_cast<Real>(sin_o * std::cos(phi_o)),
                         static_cast<Real>(sin_o * std::sin(phi_o)), static_cast<Real>(cos_o)};
      std::array<double, kChannels> albedo{}, before{};
      for (size_t row = 0; row < nodes.y.size(); ++row) {
        const double cos_h = std::sqrt(1 - nodes.y[row]), sin_h = std::sqrt(nodes.y[row]);
        const double phi_max = MaxPhi(cos_o, sin_o, cos_h, sin_h);
        std::array<double, kChannels> of_row{};
        for (int k = 0; k < nodes.s; ++k) {
          const double s = static_cast<double>(k) / (nodes.s - 1);
          const double phi = (anisotropic ? 2 * s - 1 : s) * phi_max;
          const double wo_h = cos_o * cos_h + sin_o * sin_h * std::cos(phi);
          const double phi_h = phi_o + phi;
          const double h[] = {sin_h * std::cos(phi_h), sin_h * std::sin(phi_h), cos_h};
          Vector wi;
          for (int a = 0; a < 3; ++a) wi[a] = static_cast<Real>(2 * wo_h * h[a] - wo[a]);
          wi[2] = std::max(wi[2], static_cast<Real>(least_cosine));
          const double scale =
              phi_max > 0 ? wi[2] * 4 * wo_h * phi_max / std::max(cos_h, least_cosine) : 0;
          model_.LobeValues(wi, wo, lobes.data());
          std::array<double, kChannels> value{};
          for (int m = 0; m < model_.lobes(); ++m) {
            for (int c = 0; c < kChannels; ++c) value[c] += lobes[m][c] * scale;
          }
          for (double& x : value) x = std::max(x, 0.0);
          const double end = k == 0 || k == nodes.s - 1 ? 0.5 : 1;
          for (int c = 0; c < kChannels; ++c) of_row[c] += value[c] * end / (nodes.s - 1);
          values.push_back(static_cast<float>(MeanOf(value)));
          if (!(values.back() <= std::numeric_limits<float>::max())) {
            Overflow();
          }
        }
        for (int c = 0; row > 0 && c < kChannels; ++c) {
          albedo[c] += (before[c] + of_row[c]) / 2 * (nodes.y[row] - nodes.y[row - 1]);
        }
        before = of_row;
      }
      Colour& rounded = albedo_.emplace_back();
      for (int c = 0; c < kChannels; ++c) rounded[c] = static_cast<Real>(albedo[c]);
    }
  }
  half_vectors_ = HalfVectorTable<Real>(nodes, values);
}

template <typename Real>
typename Bsdf<Real>::Outgoing Bsdf<Real>::Prepare(const Vector& wo) const {
  Outgoing outgoing;
  outgoing.sin = std::sqrt(wo[0] * wo[0] + wo[1] * wo[1]);
  const bool at_normal = !(outgoing.sin > static_cast<Real>(1e-9));
  outgoing.cos_phi = at_normal ? Real{1} : wo[0] / outgoing.sin;
  outgoing.sin_phi = at_normal ? Real{0} : wo[1] / outgoing.sin;
  // No half vector further than half of theta_o + 90 degrees has a wi above the surface.
  outgoing.at = half_vectors_.At(std::atan2(outgoing.sin, wo[2]),
                                 anisotropic() && !at_normal ? std::atan2(wo[1], wo[0]) : Real{0},
                                 std::min((1 + outgoing.sin) / 2, Real{1}));
  const Real lobes = outgoing.at.total;
  const Real diffuse = diffuse_albedo_ + static_cast<Real>(kCosineShare) * lobes;
  outgoing.cosine_part = lobes > 0 ? diffuse / (diffuse + lobes) : Real{1};
  return outgoing;
}

template <typename Real>
typename Bsdf<Real>::Colour Bsdf<Real>::Albedo(const Vector& w) const {
  if (!IsAbove(w)) return {};
  const Outgoing outgoing = Prepare(w);
  Colour albedo;
  for (int c = 0; c < kChannels; ++c) {
    albedo[c] = model_.diffuse()[c] * static_cast<Real>(kPi);
    for (int k = 0; k < outgoing.at.count; ++k) {
      albedo[c] += outgoing.at.weight[k] * albedo_[outgoing.at.node[k]][c];
    }
  }
  return albedo;
}

template <typename Real>
Real Bsdf<Real>::LobesPdf(const Vector& wo, const Outgoing& outgoing, const Vector& wi) const {
  const auto& at = outgoing.at;
  Vector h = {wi[0] + wo[0], wi[1] + wo[1], wi[2] + wo[2]};
  const Real length = std::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
  for (Real& x : h) x /= length;
  const Real y = h[0] * h[0] + h[1] * h[1], sin_h = std::sqrt(y);
  const Real phi_max = MaxPhi(wo[2], outgoing.sin, h[2], sin_h);
  const Real wo_h = length / 2;  // |wi + wo| = 2 (wo . h)
  if (!(at.total > 0 && phi_max > 0 && wo_h > 0)) return 0;
  const Real phi = std::atan2(h[1] * outgoing.cos_phi - h[0] * outgoing.sin_phi,
                              h[0] * outgoing.cos_phi + h[1] * outgoing.sin_phi);
  const Real s = anisotropic() ? (phi / phi_max + 1) / 2 : std::abs(phi) / phi_max;
  return half_vectors_.Value(at, y, s) / at.total * h[2] / (4 * wo_h * phi_max);
}

template <typename Real>
Real Bsdf<Real>::Pdf(const Vector& wo, const Vector& wi) const {
  if (!(IsAbove(wo) && IsAbove(wi))) return 0;
  const Outgoing outgoing = Prepare(wo);
  const Real cosine = wi[2] * static_cast<Real>(1 / kPi);
  return outgoing.cosine_part * cosine + (1 - outgoing.cosine_part) * LobesPdf(wo, outgoing, wi);
}

template <typename Real>
typename Bsdf<Real>::Sample Bsdf<Real>::SampleWi(const Vector& wo,
                                                 const std::array<Real, 2>& u) const {
  Sample sample;
  if (!IsAbove(wo)) return sample;
  const Outgoing outgoing = Prepare(wo);
  const Real below_one = 1 - std::numeric_limits<Real>::epsilon();
  const Real part = outgoing.cosine_part;
  const auto inside = [&](Real x) { return x > 0 ? std::min(x, below_one) : Real{0}; };
  const Real u0 = inside(u[0]), u1 = inside(u[1]);
  Real lobes_pdf = 0;
  if (u0 < part) {
    const Real r2 = u0 / part, phi = static_cast<Real>(2 * kPi) * u1, r = std::sqrt(r2);
    sample.wi = {r * std::cos(phi), r * std::sin(phi),
                 std::sqrt(std::max(1 - r2, std::numeric_limits<Real>::min()))};
    lobes_pdf = part < 1 ? LobesPdf(wo, outgoing, sample.wi) : Real{0};
  } else {
    const Real around = 2 * u1 - 1;
    const auto drawn = half_vectors_.Draw(outgoing.at, inside((u0 - part) / (1 - part)),
                                          anisotropic() ? u1 : std::abs(around));
    const Real sin_h = std::sqrt(drawn.y), cos_h = std::sqrt(std::max(1 - drawn.y, Real{0}));
    const Real phi_max = MaxPhi(wo[2], outgoing.sin, cos_h, sin_h);
    const Real phi = phi_max * (anisotropic() ? 2 * drawn.s - 1 : std::copysign(drawn.s, around));
    const Real x = sin_h * std::cos(phi), y = sin_h * std::sin(phi);
    const Vector h = {x * outgoing.cos_phi - y * outgoing.sin_phi,
                      x * outgoing.sin_phi + y * outgoing.cos_phi, cos_h};
    const Real twice = 2 * (wo[0] * h[0] + wo[1] * h[1] + wo[2] * h[2]);
    for (int a = 0; a < 3; ++a) sample.wi[a] = twice * h[a] - wo[a];
    lobes_pdf = phi_max > 0 && twice > 0
                    ? drawn.value / outgoing.at.total * cos_h / (2 * twice * phi_max)
                    : Real{0};
  }
  if (!(sample.wi[2] > 0)) return sample;  // by rounding, at the horizon
  sample.pdf = part * sample.wi[2] * static_cast<Real>(1 / kPi) + (1 - part) * lobes_pdf;
  if (!(sample.pdf > 0)) return sample;
  sample.weight = Value(sample.wi, wo);
  for (Real& w : sample.weight) w *= sample.wi[2] / sample.pdf;
  return sample;
}

template class Bsdf<double>;
template class Bsdf<float>;

}  // namespace trilobe
