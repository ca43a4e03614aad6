#include "trilobe/model/lobe_light.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "trilobe/base/error.h"
#include "trilobe/brdf/merl_grid.h"
#include "trilobe/math/catmull_rom.h"

namespace trilobe {
namespace {

// Of phi_d, over [0, 90 degrees]: the other half holds the exchanged directions.
constexpr int kPhiSteps = 12;

MerlGrid GridOf(const ModelSpec& spec) {
  return {.theta_h = spec.d_bins, .theta_d = spec.f_bins, .phi_d = 2 * kPhiSteps};
}

double Mean(const Rgb& rgb) { return (rgb[0] + rgb[1] + rgb[2]) / 3; }

double Total(const LobeLight& light) {
  double total = Mean(light.diffuse);
  for (const Rgb& lobe : light.lobes) total += Mean(lobe);
  return total;
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
  const ModelSpec& spec = model.spec();
  const MerlGrid grid = GridOf(spec);
  const CatmullRom spline(spec.g_nodes);
  LobeLight light;
  light.lobes.resize(spec.lobes);
  light.through.assign(model.parameters().size(), 0.0);
  // Entries of a factor are live or dead in all its tables alike, but for channels without weight.
  const auto live = [&](Factor factor, int entry) {
    for (int t = 0; t < spec.num_tables(factor); ++t) {
      if (coverage[model.TableOffset(factor, t) + entry] > 0) return true;
    }
    return spec.num_tables(factor) == 0;
  };
  const auto all_live = [&](const Stencil& stencil) {
    for (int k = 0; k < stencil.size; ++k) {
      if (stencil.weight[k] != 0 && !live(Factor::kG, stencil.index[k])) return false;
    }
    return true;
  };
  double all = 0;
  for (int h = 0; h < grid.theta_h; ++h) {
    if (!live(Factor::kD, h)) continue;
    for (int d = 0; d < grid.theta_d; ++d) {
      if (!live(Factor::kF, d)) continue;
      const double solid_angle = grid.SolidAngle(h, d);
      for (int p = 0; p < kPhiSteps; ++p) {
        const Cosines cosines = ToCosines(grid.Center(h, d, p));
        if (!(cosines.i > 0 && cosines.o > 0)) continue;
        const Stencil G_i = spline.StencilAt(std::acos(cosines.i));
        const Stencil G_o = spline.StencilAt(std::acos(cosines.o));
        if (!all_live(G_i) || !all_live(G_o)) continue;
        const double white = solid_angle * cosines.i * cosines.o;
        all += white;
        for (int c = 0; c < kChannels; ++c) {
          light.diffuse[c] += white * model.d()[c];
          for (int m = 0; m < spec.lobes; ++m) {
            const int D = model.TableOffset(Factor::kD, spec.table(Factor::kD, m, c)) + h;
            const int F = model.TableOffset(Factor::kF, spec.table(Factor::kF, m, c)) + d;
            const int G = model.TableOffset(Factor::kG, spec.table(Factor::kG, m, c));
            // The cosines of the lobe's denominator and those of the integral cancel.
            const double part = solid_angle * model.s(m)[c] * model.parameters()[D] *
                                model.parameters()[F] * std::max(G_i(model.G(m, c)), 0.0) *
                                std::max(G_o(model.G(m, c)), 0.0);
            light.lobes[m][c] += part;
            light.through[D] += part;
            light.through[F] += part;
            for (const Stencil* const stencil : {&G_i, &G_o}) {
              for (int k = 0; k < stencil->size; ++k) {
                light.through[G + stencil->index[k]] += part * std::abs(stencil->weight[k]);
              }
            }
          }
        }
      }
    }
  }
  // A Lambertian rho has the albedo pi rho.
  const double scale = all > 0 ? kPi / all : 0;
  for (double& x : light.diffuse) x *= scale;
  for (Rgb& lobe : light.lobes) {
    for (double& x : lobe) x *= scale;
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
