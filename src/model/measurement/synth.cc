#include "trilobe/model/measurement/synth.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <optional>

#include "core/base/grid_cosines.h"
#include "core/base/names.h"
#include "model/measurement/anisotropic_materials.h"
#include "model/measurement/counter_random.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// --- Building blocks, all reciprocal ------------------------------------------------------------

// The angles of two directions for the analytic lobes.
struct Geometry {
  explicit Geometry(const DirectionPair& pair)
      : cos_i(pair.wi[2]), cos_o(pair.wo[2]), wi_dot_wo(Dot(pair.wi, pair.wo)) {
    const Direction h{pair.wi[0] + pair.wo[0], pair.wi[1] + pair.wo[1], pair.wi[2] + pair.wo[2]};
    const double length2 = Dot(h, h);
    cos2_h = h[2] * h[2] / length2;
    sin2_h = (h[0] * h[0] + h[1] * h[1]) / length2;
    cos_d = std::sqrt(length2) / 2;
  }

  double cos_i, cos_o;
  double wi_dot_wo;
  double cos2_h, sin2_h;  // of theta_h; both, since 1 - cos2_h loses digits in narrow highlights
  double cos_d;
};

double Square(double x) { return x * x; }

// D V, the GGX distribution times G / (4 cos theta_i cos theta_o) with the height-correlated Smith
// G (Walter et al. 2007; Heitz 2014). The lobe is this times a Fresnel term.
double Ggx(const Geometry& g, double alpha) {
  const double alpha2 = alpha * alpha;
  const double distribution = alpha2 / (kPi * Square(g.sin2_h + alpha2 * g.cos2_h));
  const auto smith = [alpha2](double c) { return std::sqrt(alpha2 + (1 - alpha2) * c * c); };
  return distribution / (2 * (g.cos_o * smith(g.cos_i) + g.cos_i * smith(g.cos_o)));
}

// Schlick's approximation of the Fresnel reflectance, from its value at normal incidence.
double Schlick(double f0, double cosine) { return f0 + (1 - f0) * std::pow(1 - cosine, 5); }

// Fresnel reflectance of unpolarised light by a conductor of index eta + i k.
double ConductorFresnel(double eta, double k, double cosine) {
  const std::complex<double> n(eta, k);
  const std::complex<double> t = std::sqrt(n * n - (1 - cosine * cosine));  // n cos theta_t
  const auto s_polarised = (cosine - t) / (cosine + t);
  const auto p_polarised = (n * n * cosine - t) / (n * n * cosine + t);
  return (std::norm(s_polarised) + std::norm(p_polarised)) / 2;
}

// Share of the light that a smooth coat lets in along one direction and out along the other.
double CoatTransmission(const Geometry& g, double f0) {
  return (1 - Schlick(f0, g.cos_i)) * (1 - Schlick(f0, g.cos_o));
}

template <typename PerChannel>
Rgb ForChannels(const PerChannel& value) {
  return {value(0), value(1), value(2)};
}

constexpr double kDielectric = 0.04;  // reflectance of index 1.5 at normal incidence

// A dielectric coat of roughness `alpha` over a Lambertian base.
Rgb CoatedDiffuse(const Geometry& g, const Rgb& base_albedo, double alpha) {
  const double coat = Ggx(g, alpha) * Schlick(kDielectric, g.cos_d);
  const double through = CoatTransmission(g, kDielectric) / kPi;
  return ForChannels([&](int c) { return base_albedo[c] * through + coat; });
}

// --- The materials ------------------------------------------------------------------------------

Rgb Plastic(const DirectionPair& pair) {
  return CoatedDiffuse(Geometry(pair), {0.02, 0.20, 0.34}, 0.1);
}

Rgb CarPaint(const DirectionPair& pair) {
  const Geometry g(pair);
  constexpr Rgb kBase = {0.16, 0.012, 0.014}, kFlakes = {0.42, 0.10, 0.07};
  const double clear_coat = Ggx(g, 0.02) * Schlick(kDielectric, g.cos_d);
  const double through = CoatTransmission(g, kDielectric);
  const double flakes = Ggx(g, 0.35);
  return ForChannels([&](int c) {
    return clear_coat + through * (kBase[c] / kPi + flakes * Schlick(kFlakes[c], g.cos_d) / 2);
  });
}

Rgb Copper(const DirectionPair& pair) {
  const Geometry g(pair);
  constexpr Rgb kEta = {0.20, 0.92, 1.10}, kK = {3.91, 2.45, 2.14};
  const double lobe = Ggx(g, 0.2);
  return ForChannels([&](int c) { return lobe * ConductorFresnel(kEta[c], kK[c], g.cos_d); });
}

// Ground metal: a polished and a scratched part.
Rgb Aluminium(const DirectionPair& pair) {
  const Geometry g(pair);
  constexpr Rgb kEta = {1.35, 0.97, 0.62}, kK = {7.48, 6.40, 5.30};
  const double lobe = 0.4 * Ggx(g, 0.06) + 0.6 * Ggx(g, 0.25);
  return ForChannels([&](int c) { return lobe * ConductorFresnel(kEta[c], kK[c], g.cos_d); });
}

Rgb Chrome(const DirectionPair& pair) {
  const Geometry g(pair);
  constexpr Rgb kEta = {3.11, 3.18, 2.30}, kK = {3.31, 3.33, 3.13};
  const double lobe = Ggx(g, 0.01) + 0.004 / kPi;  // and a trace of haze
  return ForChannels([&](int c) { return lobe * ConductorFresnel(kEta[c], kK[c], g.cos_d); });
}

// Lambertian, plus fibres that stand up: the sheen distribution of Estevez and Kulla 2017 with the
// visibility of Neubelt and Pettineo 2013.
Rgb Felt(const DirectionPair& pair) {
  const Geometry g(pair);
  constexpr Rgb kBase = {0.42, 0.10, 0.16}, kSheen = {0.22, 0.12, 0.14};
  constexpr double kInverseRoughness = 2.5;
  const double distribution =
      (2 + kInverseRoughness) * std::pow(g.sin2_h, kInverseRoughness / 2) / (2 * kPi);
  const double sheen = distribution / (4 * (g.cos_i + g.cos_o - g.cos_i * g.cos_o));
  return ForChannels([&](int c) { return kBase[c] / kPi + kSheen[c] * sheen; });
}

// A rough diffuser, brighter towards the light (Oren and Nayar 1994, first-order form).
Rgb Foam(const DirectionPair& pair) {
  const Geometry g(pair);
  constexpr Rgb kAlbedo = {0.80, 0.76, 0.66};
  constexpr double kSigma2 = 0.35;  // variance of the facet slopes
  constexpr double kA = 1 - 0.5 * kSigma2 / (kSigma2 + 0.33),
                   kB = 0.45 * kSigma2 / (kSigma2 + 0.09);
  // sin theta_i sin theta_o cos(phi_i - phi_o), which over max(cos) is sin(alpha) tan(beta) cos.
  const double s = g.wi_dot_wo - g.cos_i * g.cos_o;
  const double tilt = kA + kB * std::max(s, 0.0) / std::max(g.cos_i, g.cos_o);
  return ForChannels([&](int c) { return kAlbedo[c] / kPi * tilt; });
}

Rgb Rubber(const DirectionPair& pair) {
  return CoatedDiffuse(Geometry(pair), {0.03, 0.03, 0.033}, 0.45);
}

// --- The measurement ----------------------------------------------------------------------------

// Share of the bins that a goniometer loses: none up to 80 degrees from the normal, then linearly
// up to 30 % at the horizon.
double LossProbability(double min_cosine) {
  constexpr double kStart = DegreesToRadians(80);
  return 0.3 * std::max(std::acos(min_cosine) - kStart, 0.0) / (kPi / 2 - kStart);
}

void CheckNoise(double noise) {
  if (noise >= 0 && noise <= 1) return;
  throw Error(ErrorKind::kRange, "noise is " + std::to_string(noise) + "; it must be from 0 to 1")
      .About("noise", noise);
}

void CheckBrdf(const SynthMaterial& material) {
  if (!material.brdf) {
    throw Error(ErrorKind::kMissing, "synth:" + material.name + " has no BRDF")
        .At("synth:" + material.name)
        .About("brdf");
  }
}

// Simulated measurement of direction pair `index`; nothing if it is lost.
std::optional<Rgb> Measure(const SynthMaterial& material, const DirectionPair& pair, double noise,
                           uint64_t seed, uint64_t index) {
  // Counters 8 index .. 8 index + 7: a pair of uniforms a channel, and one for the loss.
  const uint64_t counter = 4 * index;
  const double min_cosine = std::min(pair.wi[2], pair.wo[2]);
  if (noise > 0 && UniformAt(seed, 2 * (counter + 3)) < LossProbability(min_cosine)) return {};
  Rgb rho = material.brdf(pair);
  // exp(sigma z - sigma^2/2) has mean 1 and relative standard deviation `noise`.
  const double sigma = std::sqrt(std::log1p(noise * noise));
  for (int c = 0; c < kChannels && noise > 0; ++c) {
    rho[c] *= std::exp(sigma * NormalAt(seed, counter + c) - sigma * sigma / 2);
  }
  return rho;
}

std::vector<SynthMaterial> AllMaterials() {
  std::vector<SynthMaterial> materials = {
      {"plastic", "glossy blue plastic: rough dielectric coat over a diffuse base", Plastic},
      {"car-paint", "red metallic paint: diffuse base, broad flakes, narrow clear coat", CarPaint},
      {"copper", "sand-blasted copper: one coloured conductor lobe", Copper},
      {"aluminium", "ground aluminium: a narrow and a broad conductor lobe", Aluminium},
      {"chrome", "polished chrome: a highlight about one degree wide, with faint haze", Chrome},
      {"felt", "pink felt: diffuse with sheen at grazing angles", Felt},
      {"foam", "cream foam: rough diffuser that is brighter towards the light", Foam},
      {"rubber", "black rubber: dark, with a broad highlight", Rubber},
  };
  std::ranges::move(AnisotropicMaterials(), std::back_inserter(materials));
  return materials;
}

}  // namespace

const std::vector<SynthMaterial>& SynthMaterials() {
  static const std::vector<SynthMaterial> materials = AllMaterials();
  return materials;
}

const SynthMaterial& FindSynthMaterial(std::string_view name) {
  return FindNamed("synthetic material", name, SynthMaterials());
}

BrdfTable Synthesize(const SynthMaterial& material, double noise, uint64_t seed,
                     const MerlGrid& grid, int num_threads) {
  CheckNoise(noise);
  CheckBrdf(material);
  if (material.anisotropic) {
    throw Error(ErrorKind::kUnsupported,
                "synth:" + material.name +
                    " is anisotropic, which a MERL table cannot hold; use it as scattered samples")
        .At("synth:" + material.name)
        .About("anisotropic");
  }
  BrdfTable table = MakeInvalidTable("synth:" + material.name, grid);
  const GridCosines cosines_at(grid);
  ParallelFor(grid.theta_h, num_threads, [&](int h) {
    const int row = grid.theta_d * grid.phi_d;
    for (int bin = h * row; bin < (h + 1) * row; ++bin) {
      const Cosines cosines = cosines_at(bin);
      if (!(std::min(cosines.i, cosines.o) > 0)) continue;
      const auto rho = Measure(material, ToDirections(grid.Center(bin)), noise, seed, bin);
      for (int c = 0; c < kChannels && rho; ++c) table.SetValue(c, bin, (*rho)[c]);
    }
  });
  return table;
}

Measurement SynthesizeSamples(const SynthMaterial& material, double noise, uint64_t seed,
                              const HemisphereGrid& grid, int num_threads) {
  CheckNoise(noise);
  CheckBrdf(material);
  CheckHemisphereGrid(grid);
  const auto nodes = static_cast<size_t>(grid.nodes());
  std::vector<std::optional<Rgb>> measured(nodes * nodes);
  ParallelFor(grid.nodes(), num_threads, [&](int i) {
    for (size_t o = 0; o < nodes; ++o) {
      const size_t index = i * nodes + o;
      measured[index] =
          Measure(material, ToDirections(grid.Angles(i, static_cast<int>(o))), noise, seed, index);
    }
  });
  SampleCollector collector("synth:" + material.name, "synthetic measurement, scattered");
  for (size_t index = 0; index < measured.size(); ++index) {
    if (measured[index]) {
      collector.Add(grid.Angles(static_cast<int>(index / nodes), static_cast<int>(index % nodes)),
                    *measured[index]);
    } else {
      collector.LeaveOut(&BinCounts::missing);
    }
  }
  Measurement measurement = collector.Take();
  measurement.anisotropic = true;
  measurement.formula = material.brdf;
  return measurement;
}

}  // namespace trilobe
