#include "model/measurement/anisotropic_materials.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace trilobe {
namespace {

double Gaussian(double x, double sigma) {
  return std::exp(-x * x / (2 * sigma * sigma)) / (sigma * std::sqrt(2 * kPi));
}

// Fresnel reflectance of a dielectric for unpolarised light.
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

Direction UnitHalf(const DirectionPair& pair) {
  Direction h{pair.wi[0] + pair.wo[0], pair.wi[1] + pair.wo[1], pair.wi[2] + pair.wo[2]};
  const double length = std::hypot(h[0], h[1], h[2]);
  for (double& x : h) x /= length;
  return h;
}

double Square(double x) { return x * x; }

// Standard deviations of the slopes along x and y, or similar parameters.
struct Roughness {
  double x = 0.1, y = 0.1;
};

// --- Ward ---------------------------------------------------------------------------------------

// G. J. Ward, "Measuring and Modeling Anisotropic Reflection", 1992, eq. 5a, with the parameters of
// its Table 1: rho_d / pi + rho_s exp(-tan^2 delta (cos^2 phi / a_x^2 + sin^2 phi / a_y^2))
// / (4 pi a_x a_y sqrt(cos theta_i cos theta_o)), delta and phi the angles of the half vector.
// (Later variants have other divisors than the square root.) Ward gives luminances; the colours,
// which have luminance 1, are ours.
struct Ward {
  double rho_d = 0, rho_s = 0;
  Roughness a;
  Rgb diffuse_color = {1, 1, 1}, specular_color = {1, 1, 1};

  Rgb operator()(const DirectionPair& pair) const {
    const Direction h = UnitHalf(pair);
    const double slopes = (Square(h[0] / a.x) + Square(h[1] / a.y)) / Square(h[2]);
    const double lobe =
        rho_s * std::exp(-slopes) / (4 * kPi * a.x * a.y * std::sqrt(pair.wi[2] * pair.wo[2]));
    Rgb rho;
    for (int c = 0; c < kChannels; ++c) {
      rho[c] = diffuse_color[c] * rho_d / kPi + specular_color[c] * lobe;
    }
    return rho;
  }
};

constexpr Rgb kBrass = {1.131, 1.006, 0.553}, kAluminium = {0.99, 1.00, 1.03},
              kWood = {1.45, 0.93, 0.40}, kTurquoise = {0.35, 1.10, 1.90}, kWhite = {1, 1, 1};

// --- GGX ----------------------------------------------------------------------------------------

// A lobe of the anisotropic GGX distribution with the height-correlated Smith G (Walter et al.
// 2007; Heitz 2014) and Schlick's Fresnel term from `f0`, on a Lambertian base that is seen through
// what the lobe does not reflect.
struct AnisotropicGgx {
  Roughness alpha;
  Rgb f0{}, base{};

  Rgb operator()(const DirectionPair& pair) const {
    const Direction h = UnitHalf(pair);
    const double d = 1 / (kPi * alpha.x * alpha.y *
                          Square(Square(h[0] / alpha.x) + Square(h[1] / alpha.y) + Square(h[2])));
    const auto smith = [this](const Direction& w) {
      return std::hypot(alpha.x * w[0], alpha.y * w[1], w[2]);
    };
    const double lobe = d / (2 * (pair.wo[2] * smith(pair.wi) + pair.wi[2] * smith(pair.wo)));
    const double cos_d = Dot(h, pair.wi);
    const auto schlick = [](double at_normal, double cosine) {
      return at_normal + (1 - at_normal) * std::pow(std::max(1 - cosine, 0.0), 5);
    };
    Rgb rho;
    for (int c = 0; c < kChannels; ++c) {
      rho[c] = lobe * schlick(f0[c], cos_d) +
               base[c] / kPi * (1 - schlick(f0[c], pair.wi[2])) * (1 - schlick(f0[c], pair.wo[2]));
    }
    return rho;
  }
};

// --- Cloths -------------------------------------------------------------------------------------

// Table II of Sadeghi et al. 2013; the lengths of the tangent curves' parts are confirmed by no
// second transcription of it.
const Thread kLinenThread = {.eta = 1.46,
                             .color = {0.06, 0.24, 0.30},
                             .k_d = 0.3,
                             .gamma_s = 12,
                             .gamma_v = 24,
                             .area = 0.33,
                             .tangent_offsets = {-25, 25},
                             .lengths = {1}};

Cloth Linen() { return {kLinenThread, kLinenThread}; }

Cloth CrepeDeChine() {
  return {Thread{.eta = 1.345,
                 .color = {0.12, 0.114, 0.006},
                 .k_d = 0.2,
                 .gamma_s = 5,
                 .gamma_v = 10,
                 .area = 0.75,
                 .tangent_offsets = {-35, -35, 35, 35},
                 .lengths = {1, 1, 1}},
          Thread{.eta = 1.345,
                 .color = {0.16, 0.152, 0.008},
                 .k_d = 0.3,
                 .gamma_s = 18,
                 .gamma_v = 32,
                 .area = 0.25,
                 .tangent_offsets = {0, 0},
                 .lengths = {1}}};
}

Cloth Charmeuse() {
  return {Thread{.eta = 1.539,
                 .color = {0.035, 0.01295, 0.0105},
                 .k_d = 0.1,
                 .gamma_s = 2.5,
                 .gamma_v = 5,
                 .area = 0.9,
                 .tangent_offsets = {-32, -32, -18, 0, 0, 18, 32, 32},
                 .lengths = {1.33, 0.66, 2, 2, 2, 0.66, 1.33}},
          Thread{.eta = 1.539,
                 .color = {0.2, 0.074, 0.06},
                 .k_d = 0.7,
                 .gamma_s = 30,
                 .gamma_v = 60,
                 .area = 0.1,
                 .tangent_offsets = {0, 0},
                 .lengths = {1}}};
}

Cloth ShotSilk() {
  return {Thread{.eta = 1.345,
                 .color = {0.02, 0.2, 0.08},
                 .k_d = 0.1,
                 .gamma_s = 4,
                 .gamma_v = 8,
                 .area = 0.86,
                 .tangent_offsets = {-25, -25, 25, 25},
                 .lengths = {1.33, 2.67, 1.33}},
          Thread{.eta = 1.345,
                 .color = {0.6, 0, 0.06},
                 .k_d = 0.1,
                 .gamma_s = 5,
                 .gamma_v = 10,
                 .area = 0.14,
                 .tangent_offsets = {0, 0},
                 .lengths = {1}}};
}

Cloth Velvet() {
  Thread along_x = {.eta = 1.46,
                    .color = {0.015, 0.006, 0},
                    .k_d = 0.1,
                    .gamma_s = 6,
                    .gamma_v = 12,
                    .area = 0.5,
                    .tangent_offsets = {-90, -50},
                    .lengths = {1}};
  Thread along_y = along_x;
  along_y.tangent_offsets = {-90, -55, 55, 90};
  along_y.lengths = {0.5, 0, 0.5};
  return {along_x, along_y};
}

SynthMaterial Anisotropic(const char* name, const char* description, BrdfFunction brdf) {
  return {name, description, std::move(brdf), /*anisotropic=*/true};
}

}  // namespace

MicrocylinderBrdf::MicrocylinderBrdf(const Cloth& cloth) : cloth_(cloth), gap_(1) {
  for (int k = 0; k < static_cast<int>(cloth.size()); ++k) {
    const Thread& thread = cloth[k];
    gap_ -= thread.area;
    const double length = std::accumulate(thread.lengths.begin(), thread.lengths.end(), 0.0);
    for (size_t part = 0; part < thread.lengths.size(); ++part) {
      const double begin = thread.tangent_offsets[part], end = thread.tangent_offsets[part + 1];
      // Steps of half the narrowest term's standard deviation make a smooth sum.
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

std::vector<SynthMaterial> AnisotropicMaterials() {
  return {
      Anisotropic("linen", "blue linen, plain weave: threads alike in both directions",
                  MicrocylinderBrdf(Linen())),
      Anisotropic("crepe_de_chine", "yellow silk: flat threads across twisted ones",
                  MicrocylinderBrdf(CrepeDeChine())),
      Anisotropic("charmeuse", "salmon polyester satin: long shining threads over dull ones",
                  MicrocylinderBrdf(Charmeuse())),
      Anisotropic("shot_silk", "green silk shot with red threads", MicrocylinderBrdf(ShotSilk())),
      Anisotropic("velvet", "dark red velvet whose pile leans towards x",
                  MicrocylinderBrdf(Velvet())),
      Anisotropic("rolled_brass", "brass rolled along x (Ward 1992)",
                  Ward{0.10, 0.33, {0.050, 0.16}, kBrass, kBrass}),
      Anisotropic("rolled_aluminium", "aluminium rolled along x (Ward 1992)",
                  Ward{0.10, 0.21, {0.04, 0.09}, kAluminium, kAluminium}),
      Anisotropic("brushed_aluminium", "aluminium lightly brushed along x (Ward 1992)",
                  Ward{0.15, 0.19, {0.088, 0.13}, kAluminium, kAluminium}),
      Anisotropic("varnished_plywood", "plywood under varnish, grain along x (Ward 1992)",
                  Ward{0.33, 0.025, {0.04, 0.11}, kWood, kWhite}),
      Anisotropic("enamelled_metal", "turquoise enamel, nearly isotropic (Ward 1992)",
                  Ward{0.25, 0.047, {0.080, 0.096}, kTurquoise, kWhite}),
      Anisotropic("aniso_ggx_steel", "steel strongly brushed along x",
                  AnisotropicGgx{{0.08, 0.40}, {0.56, 0.57, 0.58}}),
      Anisotropic("aniso_ggx_gold", "gold leaf, softly brushed along x",
                  AnisotropicGgx{{0.15, 0.35}, {1.00, 0.71, 0.29}}),
      Anisotropic("aniso_ggx_lacquer", "red lacquer with a grain along x",
                  AnisotropicGgx{{0.06, 0.20}, {0.04, 0.04, 0.04}, {0.45, 0.05, 0.04}}),
  };
}

}  // namespace trilobe
