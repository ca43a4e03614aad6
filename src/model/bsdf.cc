#include "trilobe/model/bsdf.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>

#include "core/base/lanes.h"
#include "model/albedo_table.h"
#include "model/cover_spikes.h"
#include "model/max_phi.h"
#include "model/sampling_table.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/half_vector_table.h"

namespace trilobe {
namespace {

// Block size for many samples: the steps of independent samples overlap in the processor, while
// those of one sample wait for each other.
constexpr size_t kBlock = 32;

void CheckAsMany(size_t wi, size_t others, size_t results) {
  if (wi == results && others == results) return;
  throw Error(ErrorKind::kMismatch, "there are " + std::to_string(wi) + " wi, " +
                                        std::to_string(others) +
                                        " of what goes with them, and room for " +
                                        std::to_string(results) + " results; give as many of each")
      .About("wi", wi);
}

// Whether a direction is finite and above the surface.
template <typename Vector>
bool IsAbove(const Vector& w) {
  return w[2] > 0 && std::isfinite(w[0]) && std::isfinite(w[1]) && std::isfinite(w[2]);
}

}  // namespace

template <typename Real>
Bsdf<Real>::Bsdf(const FactorModel& model)
    : model_(model),
      half_vectors_(std::make_shared<SamplingTable<Real>>(model)),
      albedos_(std::make_shared<AlbedoTable<Real>>(model.spec())) {}

template <typename Real>
const HalfVectorTable<Real>& Bsdf<Real>::half_vectors() const {
  return half_vectors_->Of(model_);
}

template <typename Real>
typename Bsdf<Real>::Incident Bsdf<Real>::Prepare(const Vector& wi) const {
  Incident incident;
  incident.sin = std::sqrt(wi[0] * wi[0] + wi[1] * wi[1]);
  const bool at_normal = !(incident.sin > static_cast<Real>(1e-9));
  incident.cos_phi = at_normal ? Real{1} : wi[0] / incident.sin;
  incident.sin_phi = at_normal ? Real{0} : wi[1] / incident.sin;
  // Half vectors beyond half of theta_i + 90 degrees have no wo above the surface.
  const Real phi_i =
      anisotropic() ? std::copysign(AngleOfCosine(incident.cos_phi), incident.sin_phi) : Real{0};
  incident.at = half_vectors().At(AngleOfSine2(incident.sin * incident.sin), phi_i,
                                  std::min((1 + incident.sin) / 2, Real{1}));
  const Real lobes = incident.at.total;
  const Real diffuse = half_vectors_->diffuse_albedo() + static_cast<Real>(kCosineShare) * lobes;
  incident.cosine_part = lobes > 0 ? diffuse / (diffuse + lobes) : Real{1};
  return incident;
}

template <typename Real>
typename Bsdf<Real>::Colour Bsdf<Real>::Albedo(const Vector& w) const {
  if (!IsAbove(w)) return {};
  return albedos_->At(model_, AngleOfSine2(w[0] * w[0] + w[1] * w[1]), std::atan2(w[1], w[0]));
}

template <typename Real>
Real Bsdf<Real>::LobesPdf(const Vector& wi, const Incident& incident, const Vector& wo) const {
  const auto& at = incident.at;
  Vector h = {wo[0] + wi[0], wo[1] + wi[1], wo[2] + wi[2]};
  const Real length = std::sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
  for (Real& x : h) x /= length;
  const Real y = h[0] * h[0] + h[1] * h[1], sin_h = std::sqrt(y);
  const Real phi_max = MaxPhi(wi[2], incident.sin, h[2], sin_h);
  const Real wi_h = length / 2;  // |wo + wi| = 2 (wi . h)
  if (!(at.total > 0 && phi_max > 0 && wi_h > 0)) return 0;
  const Real along = h[0] * incident.cos_phi + h[1] * incident.sin_phi;
  const Real across = h[1] * incident.cos_phi - h[0] * incident.sin_phi;
  const Real phi = sin_h > 0 ? AngleOfCosine(along / sin_h) : Real{0};
  const Real s = anisotropic() ? (std::copysign(phi, across) / phi_max + 1) / 2 : phi / phi_max;
  return half_vectors().Value(at, y, s) / at.total * h[2] / (4 * wi_h * phi_max);
}

template <typename Real>
Real Bsdf<Real>::Pdf(const Vector& wi, const Vector& wo) const {
  return IsAbove(wi) && IsAbove(wo) ? PdfOf(wi, Prepare(wi), wo) : Real{0};
}

template <typename Real>
Real Bsdf<Real>::PdfOf(const Vector& wi, const Incident& incident, const Vector& wo) const {
  const Real cosine = wo[2] * static_cast<Real>(1 / kPi);
  return incident.cosine_part * cosine + (1 - incident.cosine_part) * LobesPdf(wi, incident, wo);
}

template <typename Real>
typename Bsdf<Real>::Sample Bsdf<Real>::SampleWo(const Vector& wi,
                                                 const std::array<Real, 2>& u) const {
  Sample sample;
  if (!IsAbove(wi)) return sample;
  Propose(wi, Prepare(wi), u, &sample);
  if (sample.pdf > 0) Weigh(Value(wi, sample.wo), &sample);
  return sample;
}

// The direction and its density.
template <typename Real>
void Bsdf<Real>::Propose(const Vector& wi, const Incident& incident, const std::array<Real, 2>& u,
                         Sample* proposed) const {
  Sample& sample = *proposed;
  const Real below_one = 1 - std::numeric_limits<Real>::epsilon();
  const Real part = incident.cosine_part;
  const auto inside = [&](Real x) { return x > 0 ? std::min(x, below_one) : Real{0}; };
  const Real u0 = inside(u[0]), u1 = inside(u[1]);
  Real lobes_pdf = 0;
  if (u0 < part) {
    const Real r2 = u0 / part, phi = static_cast<Real>(2 * kPi) * u1, r = std::sqrt(r2);
    sample.wo = {r * std::cos(phi), r * std::sin(phi),
                 std::sqrt(std::max(1 - r2, std::numeric_limits<Real>::min()))};
    lobes_pdf = part < 1 ? LobesPdf(wi, incident, sample.wo) : Real{0};
  } else {
    const Real around = 2 * u1 - 1;
    const auto drawn = half_vectors().Draw(incident.at, inside((u0 - part) / (1 - part)),
                                           anisotropic() ? u1 : std::abs(around));
    const Real sin_h = std::sqrt(drawn.y), cos_h = std::sqrt(std::max(1 - drawn.y, Real{0}));
    const Real phi_max = MaxPhi(wi[2], incident.sin, cos_h, sin_h);
    const Real phi = phi_max * (anisotropic() ? 2 * drawn.s - 1 : std::copysign(drawn.s, around));
    const Real x = sin_h * std::cos(phi), y = sin_h * std::sin(phi);
    const Vector h = {x * incident.cos_phi - y * incident.sin_phi,
                      x * incident.sin_phi + y * incident.cos_phi, cos_h};
    const Real twice = 2 * (wi[0] * h[0] + wi[1] * h[1] + wi[2] * h[2]);
    for (int a = 0; a < 3; ++a) sample.wo[a] = twice * h[a] - wi[a];
    lobes_pdf = phi_max > 0 && twice > 0
                    ? drawn.value / incident.at.total * cos_h / (2 * twice * phi_max)
                    : Real{0};
  }
  if (!(sample.wo[2] > 0)) return;  // by rounding, at the horizon
  sample.pdf = part * sample.wo[2] * static_cast<Real>(1 / kPi) + (1 - part) * lobes_pdf;
}

template <typename Real>
void Bsdf<Real>::Weigh(const Colour& value, Sample* sample) {
  for (int c = 0; c < kChannels; ++c) {
    sample->weight[c] = value[c] * (sample->wo[2] / sample->pdf);
  }
}

template <typename Real>
void Bsdf<Real>::SamplesOfWo(std::span<const Vector> wi, std::span<const std::array<Real, 2>> u,
                             std::span<Sample> samples) const {
  CheckAsMany(wi.size(), u.size(), samples.size());
  std::array<Incident, kBlock> incident;
  std::array<Vector, kBlock> wo;
  std::array<Colour, kBlock> values;
  for (size_t begin = 0; begin < samples.size(); begin += kBlock) {
    const size_t size = std::min(samples.size() - begin, kBlock);
    const std::span<Sample> block = samples.subspan(begin, size);
    const auto in = wi.subspan(begin, size);
    for (size_t k = 0; k < size; ++k) {
      block[k] = {};
      if (IsAbove(in[k])) incident[k] = Prepare(in[k]);
    }
    for (size_t k = 0; k < size; ++k) {
      if (IsAbove(in[k])) Propose(in[k], incident[k], u[begin + k], &block[k]);
      wo[k] = block[k].wo;
    }
    Values(in, std::span(wo).first(size), std::span(values).first(size));
    for (size_t k = 0; k < size; ++k) {
      if (block[k].pdf > 0) Weigh(values[k], &block[k]);
    }
  }
}

template <typename Real>
void Bsdf<Real>::Pdfs(std::span<const Vector> wi, std::span<const Vector> wo,
                      std::span<Real> pdfs) const {
  CheckAsMany(wi.size(), wo.size(), pdfs.size());
  std::array<Incident, kBlock> incident;
  for (size_t begin = 0; begin < pdfs.size(); begin += kBlock) {
    const size_t size = std::min(pdfs.size() - begin, kBlock);
    const auto above = [&](size_t k) { return IsAbove(wi[begin + k]) && IsAbove(wo[begin + k]); };
    for (size_t k = 0; k < size; ++k) {
      if (above(k)) incident[k] = Prepare(wi[begin + k]);
    }
    for (size_t k = 0; k < size; ++k) {
      pdfs[begin + k] = above(k) ? PdfOf(wi[begin + k], incident[k], wo[begin + k]) : Real{0};
    }
  }
}

template class Bsdf<double>;
template class Bsdf<float>;

}  // namespace trilobe
