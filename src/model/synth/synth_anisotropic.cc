#include "model/synth/synth_anisotropic.h"

#include <cmath>

#include "model/synth/microcylinder.h"

namespace trilobe {
namespace {

Direction UnitHalf(const DirectionPair& pair) {
  Direction h{pair.wi[0] + pair.wo[0], pair.wi[1] + pair.wo[1], pair.wi[2] + pair.wo[2]};
  const double length = std::hypot(h[0], h[1], h[2]);
  for (double& x : h) x /= length;
  return h;
}

double Square(double x) { return x * x; }

// Standard deviations of the slopes along x and y, or what corresponds to them.
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
