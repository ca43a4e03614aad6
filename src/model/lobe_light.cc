#include "trilobe/model/lobe_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/base/error.h"
#include "trilobe/brdf/merl_grid.h"
#include "trilobe/math/catmull_rom.h"

namespace trilobe {
namespace {

// Of phi_d, over [0, 90 degrees]: of isotropic models the other half holds the exchanged
// directions.
constexpr int kPhiSteps = 12;

// Pairs of directions whose half vectors are at an entry of D, and theta_d in a bin of F.
class Cells {
 public:
  explicit Cells(const ModelSpec& spec)
      : spec_(spec),
        grid_{.theta_h = spec.d_axis.size, .theta_d = spec.f_axis.size, .phi_d = 2 * kPhiSteps} {}

  // Of anisotropic models wi and wo exchanged are half a turn of phi_d away.
  int phi_steps() const { return spec_.d_axis.polar() ? 2 * kPhiSteps : kPhiSteps; }

  // The measure of a pair's share, in some unit.
  double SolidAngle(int h, int d) const {
    if (!spec_.d_axis.polar()) return grid_.SolidAngle(h, d);
    const double theta_d = grid_.ThetaD(d + 0.5);
    return spec_.d_axis.CellOf(h).SolidAngle() * std::sin(theta_d) * std::cos(theta_d);
  }

  // Two directions above the surface, theta and, where G is polar, phi, but for D's own.
  struct Pair {
    int d;
    // The half vectors of an entry that is read by a stretched theta_h, over those without a
    // stretch.
    double half_vectors;
    Cosines cosines;
    double theta_i, phi_i, theta_o, phi_o;
  };
  // The same for all entries of D of the theta_h of entry h, read by a stretch.
  std::vector<Pair> PairsAt(int h, const Stretch& stretch) const {
    std::vector<Pair> pairs;
    for (int d = 0; d < spec_.f_axis.size; ++d) {
      for (int p = 0; p < phi_steps(); ++p) {
        HalfDiffAngles angles = grid_.Center(0, d, p);
        const double read_at = spec_.d_axis.Theta(h);
        const double factor = stretch.Factor({angles.theta_d, angles.phi_d});
        angles.theta_h = read_at / factor;
        if (angles.theta_h >= kPi / 2) continue;
        Pair pair{.d = d,
                  .half_vectors =
                      factor == 1 ? 1 : std::sin(angles.theta_h) / (factor * std::sin(read_at)),
                  .cosines = ToCosines(angles),
                  .theta_i = 0,
                  .phi_i = 0,
                  .theta_o = 0,
                  .phi_o = 0};
        if (!(pair.cosines.i > 0 && pair.cosines.o > 0)) continue;
        pair.theta_i = std::acos(pair.cosines.i);
        pair.theta_o = std::acos(pair.cosines.o);
        if (spec_.g_axis.polar()) {
          const SphericalAngles at = ToSphericalAngles(ToDirections(angles));
          pair.phi_i = at.phi_i;
          pair.phi_o = at.phi_o;
        }
        pairs.push_back(pair);
      }
    }
    return pairs;
  }

  // How they read G.
  std::pair<Stencil, Stencil> ReadG(int h, const Pair& pair) const {
    const Axis& g = spec_.g_axis;
    if (!g.polar()) return {g.At(pair.theta_i, 0), g.At(pair.theta_o, 0)};
    const double phi = spec_.d_axis.Phi(h);
    return {g.At(pair.theta_i, pair.phi_i + phi), g.At(pair.theta_o, pair.phi_o + phi)};
  }

 private:
  const ModelSpec& spec_;
  const MerlGrid grid_;
};

double Total(const LobeLight& light) {
  double total = Mean(light.diffuse);
  for (const Rgb& lobe : light.lobes) total += Mean(lobe);
  return total;
}

// Adds what the lobes of a stretch reflect, over the places where they read D; with the first one
// what is diffuse.
void AddLight(std::span<const double> coverage, const FactorModel& model, int stretch,
              LobeLight* light) {
  const ModelSpec& spec = model.spec();
  const Cells cells(spec);
  std::vector<int> lobes;
  for (int m = 0; m < spec.lobes; ++m) {
    if (spec.stretches.index(m) == stretch) lobes.push_back(m);
  }
  // Entries are observed or unobserved in all tables of F and G, and of D in those of these lobes,
  // alike, but for channels without weight.
  const auto observed = [&](Factor factor, int entry) {
    for (const int m : lobes) {
      for (int c = 0; c < kChannels; ++c) {
        const int t = spec.table(factor, m, c);
        if (coverage[model.TableOffset(factor, t) + entry] > 0) return true;
      }
    }
    return lobes.empty();
  };
  const auto all_live = [&](const Stencil& stencil) {
    for (int k = 0; k < stencil.size; ++k) {
      if (stencil.weight[k] != 0 && !observed(Factor::kG, stencil.index[k])) return false;
    }
    return true;
  };
  double all = 0;
  Rgb diffuse{};
  const int G_tables = spec.num_tables(Factor::kG);
  std::array<double, kChannels * kMaxLobes> shadowing{}, through_G{};  // by table of G
  std::vector<Cells::Pair> pairs;
  int pairs_ring = -1;
  for (int h = 0; h < spec.d_axis.size; ++h) {
    if (!observed(Factor::kD, h)) continue;
    if (const int ring = h / spec.d_axis.phi_nodes; ring != pairs_ring) {
      pairs = cells.PairsAt(h, spec.stretches.distinct()[stretch]);
      pairs_ring = ring;
    }
    for (const Cells::Pair& pair : pairs) {
      if (!observed(Factor::kF, pair.d)) continue;
      const auto [G_i, G_o] = cells.ReadG(h, pair);
      if (!all_live(G_i) || !all_live(G_o)) continue;
      const double solid_angle = cells.SolidAngle(h, pair.d) * pair.half_vectors;
      const double white = solid_angle * pair.cosines.i * pair.cosines.o;
      all += white;
      // The cosines of a lobe's denominator and those of the integral cancel.
      for (int t = 0; t < G_tables; ++t) {
        const std::span<const double> G = model.table(Factor::kG, t);
        shadowing[t] = solid_angle * std::max(G_i(G), 0.0) * std::max(G_o(G), 0.0);
      }
      through_G.fill(0);
      for (int c = 0; c < kChannels; ++c) {
        diffuse[c] += white * model.d()[c];
        for (const int m : lobes) {
          const int D = model.TableOffset(Factor::kD, spec.table(Factor::kD, m, c)) + h;
          const int F = model.TableOffset(Factor::kF, spec.table(Factor::kF, m, c)) + pair.d;
          const int G = spec.table(Factor::kG, m, c);
          const double part =
              shadowing[G] * model.s(m)[c] * model.parameters()[D] * model.parameters()[F];
          light->lobes[m][c] += part;
          light->through[D] += part;
          light->through[F] += part;
          through_G[G] += part;
        }
      }
      for (int t = 0; t < G_tables; ++t) {
        double* const through = &light->through[model.TableOffset(Factor::kG, t)];
        for (const Stencil* const stencil : {&G_i, &G_o}) {
          for (int k = 0; k < stencil->size; ++k) {
            through[stencil->index[k]] += through_G[t] * std::abs(stencil->weight[k]);
          }
        }
      }
    }
  }
  // A Lambertian rho has the albedo pi rho.
  const double scale = all > 0 ? kPi / all : 0;
  for (const int m : lobes) {
    for (double& x : light->lobes[m]) x *= scale;
  }
  if (stretch > 0) return;
  for (int c = 0; c < kChannels; ++c) light->diffuse[c] = scale * diffuse[c];
}

}  // namespace

double LobeLight::Share(int lobe) const {
  if (lobe < 0 || lobe >= static_cast<int>(lobes.size())) {
    throw Error("there is no lobe " + std::to_string(lobe) + " among " +
                std::to_string(lobes.size()));
  }
  const double total = Total(*this);
  return total > 0 ? Mean(lobes[lobe]) / total : 0;
}

double LobeLight::DiffuseShare() const {
  const double total = Total(*this);
  return total > 0 ? Mean(diffuse) / total : 0;
}

LobeLight ComputeLobeLight(std::span<const double> coverage, const FactorModel& model) {
  CheckCoverage(coverage, model);
  LobeLight light;
  light.lobes.resize(model.spec().lobes);
  light.through.assign(model.parameters().size(), 0.0);
  for (size_t k = 0; k < model.spec().stretches.distinct().size(); ++k) {
    AddLight(coverage, model, static_cast<int>(k), &light);
  }
  return light;
}

std::vector<double> VisibleSolidAngles(int bins) {
  // The share of pairs, weighted by d omega_d = cos theta_d sin theta_d d theta_d d phi_d: for each
  // phi_d, those with tan theta_h tan theta_d |cos phi_d| < 1 are above the surface.
  constexpr int kPhi = 64;
  const MerlGrid grid{.theta_h = bins};
  CheckGrid(grid);
  std::vector<double> angles(bins);
  for (int h = 0; h < bins; ++h) {
    const double theta_h = grid.ThetaH(h + 0.5), tangent = std::tan(theta_h);
    double visible = 0;
    for (int p = 0; p < kPhi; ++p) {
      const double t = tangent * std::cos((p + 0.5) / kPhi * (kPi / 2));
      visible += 1 / (1 + t * t) / kPhi;  // sin^2 of the largest theta_d, its tangent 1 / t
    }
    angles[h] = 2 * kPi * std::sin(theta_h) * (grid.ThetaH(h + 1) - grid.ThetaH(h)) * visible;
  }
  return angles;
}

}  // namespace trilobe
