#include "model/albedo_table.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>

#include "model/max_phi.h"
#include "trilobe/core/base/angles.h"
#include "trilobe/model/half_vector_table.h"

namespace trilobe {
namespace {

constexpr int kSteps = 96;  // of s, at most

// Nodes of y, as many again between them where tables are coarse.
std::vector<double> FineNodesOfY(const ModelSpec& spec) {
  const size_t enough = spec.anisotropic() ? 48 : 150;
  std::vector<double> y = NodesOfY(spec);
  while (y.size() < enough) {
    std::vector<double> finer = {y[0]};
    for (size_t k = 1; k < y.size(); ++k) finer.insert(finer.end(), {(y[k - 1] + y[k]) / 2, y[k]});
    y = finer;
  }
  return y;
}

// Rings of theta [rad] from 0 to kGrazingTheta.
std::vector<double> RingsOf(const ModelSpec& spec) {
  std::vector<double> theta;
  if (!spec.anisotropic()) {
    const int steps = std::clamp(4 * spec.g_axis.size, 60, 360) - 2;
    for (int k = 0; k <= steps; ++k) theta.push_back(kGrazingTheta * k / steps);
    return theta;
  }
  // The nodes of G, and between them steps that are even in the root of what is left to grazing.
  constexpr int kRings = 44;
  std::vector<double> ends = {0};
  for (const double degrees : spec.g_axis.theta) {
    const double node = DegreesToRadians(degrees);
    if (node > 0 && node < kGrazingTheta) ends.push_back(node);
  }
  ends.push_back(kGrazingTheta);
  const auto root = [](double x) { return std::sqrt(1 - x / kGrazingTheta); };
  for (size_t k = 1; k < ends.size(); ++k) {
    const double begin = root(ends[k - 1]), end = root(ends[k]);
    const int steps = std::max(1, static_cast<int>(std::ceil((begin - end) * kRings - 1e-9)));
    for (int n = 0; n < steps; ++n) {
      const double left = begin + (end - begin) * n / steps;
      theta.push_back(n == 0 ? ends[k - 1] : kGrazingTheta * (1 - left * left));
    }
  }
  theta.push_back(kGrazingTheta);
  return theta;
}

// Twice as many azimuths as are integrated in all rings, among which are the nodes of both tables,
// where these are not too many, and which are twice as dense as those of one.
int AzimuthsOf(const ModelSpec& spec) {
  if (!spec.anisotropic()) return 1;
  constexpr int kLeast = 12, kMost = 144;
  const int D = std::max(spec.d_axis.phi_nodes, 1), G = std::max(spec.g_axis.phi_nodes, 1);
  const int least = std::max(2 * std::max(D, G), kLeast);
  const int64_t both = std::lcm(int64_t{D}, int64_t{G});
  const int64_t multiple = both * ((least + both - 1) / both);
  return 2 * (multiple > kMost ? least : static_cast<int>(multiple));
}

}  // namespace

template <typename Real>
AlbedoTable<Real>::AlbedoTable(const ModelSpec& spec)
    : anisotropic_(spec.anisotropic()),
      azimuths_(AzimuthsOf(spec)),
      theta_(RingsOf(spec)),
      y_(FineNodesOfY(spec)) {}

template <typename Real>
typename AlbedoTable<Real>::Colour AlbedoTable<Real>::At(const PreparedModel<Real>& model,
                                                         Real theta, Real phi) {
  std::call_once(made_, [&] {
    values_.resize(theta_.size() * azimuths_);
    for (size_t ring = 0; ring < theta_.size(); ++ring) MakeRing(model, ring);
  });
  const auto above = std::upper_bound(theta_.begin(), theta_.end(), static_cast<double>(theta));
  const int ring = std::clamp(static_cast<int>(above - theta_.begin()) - 1, 0,
                              static_cast<int>(theta_.size()) - 2);
  const double turns = static_cast<double>(phi) / (2 * kPi);
  const double a = (turns - std::floor(turns)) * azimuths_;
  const int azimuth = std::min(static_cast<int>(a), azimuths_ - 1);
  const double begin = theta_[ring], end = theta_[ring + 1];
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

// Integrates at every second azimuth, and between two of them where the albedo bends so much that a
// line would be off by kMostBend of it: by an eighth of a second difference.
template <typename Real>
void AlbedoTable<Real>::MakeRing(const PreparedModel<Real>& model, size_t ring) {
  constexpr double kMostBend = 1.5e-3;
  Albedo* const at = &values_[ring * azimuths_];
  const auto integrate = [&](int k) {
    at[k] = Integrate(model, theta_[ring], 2 * kPi * k / azimuths_);
  };
  if (azimuths_ == 1) return integrate(0);
  for (int k = 0; k < azimuths_; k += 2) integrate(k);
  const auto node = [&](int k) -> const Albedo& { return at[(k + azimuths_) % azimuths_]; };
  for (int k = 0; k < azimuths_; k += 2) {
    bool bends = false;
    for (int c = 0; c < kChannels; ++c) {
      const double step = node(k + 2)[c] - node(k)[c];
      const double before = node(k)[c] - node(k - 2)[c], after = node(k + 4)[c] - node(k + 2)[c];
      const double bend = std::max(std::abs(step - before), std::abs(after - step)) / 8;
      at[k + 1][c] = (node(k)[c] + node(k + 2)[c]) / 2;
      bends |= bend > kMostBend * at[k + 1][c];
    }
    if (bends) integrate(k + 1);
  }
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
  // Towards grazing a highlight is narrow in s, and of many rings of D each counts.
  const bool grazing = theta >= DegreesToRadians(70);
  const int steps = anisotropic_ ? (grazing ? 64 : 48) : (grazing ? kSteps : kSteps / 3);
  constexpr size_t kManyRows = 80;
  const bool every = !anisotropic_ || y_.size() < kManyRows || theta >= DegreesToRadians(60);
  const size_t stride = every ? 1 : 2;
  std::array<Vector, kSteps> wi, wo;
  wi.fill({static_cast<Real>(sin_i * cos_phi), static_cast<Real>(sin_i * sin_phi),
           static_cast<Real>(cos_i)});
  std::array<Colour, kSteps> f;
  std::array<double, kSteps> scale;
  Albedo sum{}, before{};
  for (size_t row = 0; row < y_.size(); row += stride) {
    const double cos_h = std::sqrt(1 - y_[row]), sin_h = std::sqrt(y_[row]);
    const double phi_max = MaxPhi(cos_i, sin_i, cos_h, sin_h);
    if (!(phi_max > 0)) {  // no wo is above the surface, here and further on
      for (int c = 0; row > 0 && c < kChannels; ++c) {
        sum[c] += before[c] / 2 * (y_[row] - y_[row - stride]);
      }
      break;
    }
    Albedo of_row{};
    // The next azimuth by a rotation.
    const double step = (anisotropic_ ? 2 : 1) * phi_max / steps;
    const double begin = (anisotropic_ ? -phi_max : 0) + step / 2;
    const double cos_step = std::cos(step), sin_step = std::sin(step);
    double cos_h_i = std::cos(begin), sin_h_i = std::sin(begin);
    for (int k = 0; k < steps; ++k) {
      const double wi_h = cos_i * cos_h + sin_i * sin_h * cos_h_i;
      const double along = 2 * wi_h * sin_h * cos_h_i - sin_i;
      const double across = 2 * wi_h * sin_h * sin_h_i;
      wo[k] = {static_cast<Real>(along * cos_phi - across * sin_phi),
               static_cast<Real>(along * sin_phi + across * cos_phi),
               static_cast<Real>(2 * wi_h * cos_h - cos_i)};
      scale[k] = std::max<double>(wo[k][2], 0) * 4 * wi_h * phi_max / std::max(cos_h, 1e-9);
      const double next = cos_h_i * cos_step - sin_h_i * sin_step;
      sin_h_i = sin_h_i * cos_step + cos_h_i * sin_step;
      cos_h_i = next;
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
      sum[c] += (before[c] + of_row[c]) / 2 * (y_[row] - y_[row - stride]);
    }
    before = of_row;
  }
  for (int c = 0; c < kChannels; ++c) sum[c] = std::max(sum[c] + kPi * model.diffuse()[c], 0.0);
  return sum;
}

template class AlbedoTable<double>;
template class AlbedoTable<float>;

}  // namespace trilobe
