#include "trilobe/model/objective/lobe_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "trilobe/core/base/catmull_rom.h"
#include "trilobe/core/base/error.h"
#include "trilobe/core/base/merl_grid.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/value_of.h"

namespace trilobe {
namespace {

// Steps of phi_d over [0, 90 degrees]; in isotropic models the other half has the exchanged
// directions.
constexpr int kPhiSteps = 12;

// Direction pairs with the half vector at an entry of D and theta_d in a bin of F.
class Cells {
 public:
  explicit Cells(const ModelSpec& spec)
      : spec_(spec),
        grid_{.theta_h = spec.d_axis.size, .theta_d = spec.f_axis.size, .phi_d = 2 * kPhiSteps} {}

  // In anisotropic models, exchanging wi and wo moves phi_d by half a turn.
  int phi_steps() const { return spec_.d_axis.polar() ? 2 * kPhiSteps : kPhiSteps; }

  // Measure of a pair, up to a constant factor.
  double SolidAngle(int h, int d) const {
    if (!spec_.d_axis.polar()) return grid_.SolidAngle(h, d);
    const double theta_d = grid_.ThetaD(d + 0.5);
    return spec_.d_axis.CellOf(h).SolidAngle() * std::sin(theta_d) * std::cos(theta_d);
  }

  // Two directions above the surface: theta and, if G is polar, phi relative to D's.
  struct Pair {
    int d;
    // Density of half vectors of a stretched entry relative to an unstretched one.
    double half_vectors;
    Cosines cosines;
    double theta_i, phi_i, theta_o, phi_o;
  };
  // The pairs for all entries of D with the theta_h of entry h, read with a stretch.
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

  // The stencils of G for a pair.
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

// Whether entries of these lobes' tables are observed, by factor and entry: in all tables of F and
// G, and the lobes' tables of D, alike, except for channels without weight.
using Observed = std::array<std::vector<bool>, std::size(kFactors)>;
Observed ObservedBy(std::span<const int> lobes, std::span<const double> coverage,
                    const FactorModel& model) {
  const ModelSpec& spec = model.spec();
  Observed observed;
  for (const Factor factor : kFactors) {
    std::vector<bool>& entries = observed[static_cast<size_t>(factor)];
    entries.assign(spec.table_size(factor), lobes.empty());
    for (const int m : lobes) {
      for (int c = 0; c < kChannels; ++c) {
        const int offset = model.TableOffset(factor, spec.table(factor, m, c));
        for (size_t k = 0; k < entries.size(); ++k) {
          if (coverage[offset + k] > 0) entries[k] = true;
        }
      }
    }
  }
  return observed;
}

bool AllOf(const std::vector<bool>& observed, const Stencil& stencil) {
  for (int k = 0; k < stencil.size; ++k) {
    if (stencil.weight[k] != 0 && !observed[stencil.index[k]]) return false;
  }
  return true;
}

// Light reflected by lobes of one stretch and by the diffuse term over a part of the domain of D;
// `all` is that of a white diffuse surface, in the same unit.
struct Part {
  double all = 0;
  LobeLight light;
};

LobeLight Darkness(const FactorModel& model) {
  return {.diffuse = {},
          .lobes = std::vector<Rgb>(model.spec().lobes),
          .nearly_diffuse = {},
          .through = std::vector<double>(model.parameters().size())};
}

void Add(const Part& part, Part* sum) {
  sum->all += part.all;
  const LobeLight& from = part.light;
  LobeLight& light = sum->light;
  for (int c = 0; c < kChannels; ++c) light.diffuse[c] += from.diffuse[c];
  for (size_t m = 0; m < from.lobes.size(); ++m) {
    for (int c = 0; c < kChannels; ++c) light.lobes[m][c] += from.lobes[m][c];
  }
  for (size_t k = 0; k < from.through.size(); ++k) light.through[k] += from.through[k];
}

// Adds the light reflected by lobes at the entries of D with one theta_h, a ring.
void AddRing(const Cells& cells, const Stretch& stretch, std::span<const int> lobes,
             const Observed& observed, const FactorModel& model, int ring, Part* sum) {
  const ModelSpec& spec = model.spec();
  LobeLight& light = sum->light;
  const auto& [D_observed, F_observed, G_observed] = observed;
  const int G_tables = spec.num_tables(Factor::kG), phi_nodes = spec.d_axis.phi_nodes;
  std::array<double, kChannels * kMaxLobes> shadowing{}, through_G{};  // by table of G
  const std::vector<Cells::Pair> pairs = cells.PairsAt(ring * phi_nodes, stretch);
  for (int h = ring * phi_nodes; h < (ring + 1) * phi_nodes; ++h) {
    if (!D_observed[h]) continue;
    for (const Cells::Pair& pair : pairs) {
      if (!F_observed[pair.d]) continue;
      const auto [G_i, G_o] = cells.ReadG(h, pair);
      if (!AllOf(G_observed, G_i) || !AllOf(G_observed, G_o)) continue;
      const double solid_angle = cells.SolidAngle(h, pair.d) * pair.half_vectors;
      const double white = solid_angle * pair.cosines.i * pair.cosines.o;
      sum->all += white;
      // The cosines of a lobe's denominator and those of the integral cancel.
      for (int t = 0; t < G_tables; ++t) {
        const std::span<const double> G = model.table(Factor::kG, t);
        shadowing[t] = solid_angle * std::max(G_i(G), 0.0) * std::max(G_o(G), 0.0);
      }
      through_G.fill(0);
      for (int c = 0; c < kChannels; ++c) {
        light.diffuse[c] += white * model.d()[c];
        for (const int m : lobes) {
          const int D = model.TableOffset(Factor::kD, spec.table(Factor::kD, m, c)) + h;
          const int F = model.TableOffset(Factor::kF, spec.table(Factor::kF, m, c)) + pair.d;
          const int G = spec.table(Factor::kG, m, c);
          const double part = LobeValue(shadowing[G] * model.s(m)[c], model.parameters()[D],
                                        model.parameters()[F], 1.0);
          light.lobes[m][c] += part;
          light.through[D] += part;
          light.through[F] += part;
          through_G[G] += part;
        }
      }
      for (int t = 0; t < G_tables; ++t) {
        double* const through = &light.through[model.TableOffset(Factor::kG, t)];
        for (const Stencil* const stencil : {&G_i, &G_o}) {
          for (int k = 0; k < stencil->size; ++k) {
            through[stencil->index[k]] += through_G[t] * std::abs(stencil->weight[k]);
          }
        }
      }
    }
  }
}

// Light of the lobes of one stretch over the whole domain of D.
Part PartOf(std::span<const int> lobes, const Stretch& stretch, std::span<const double> coverage,
            const FactorModel& model, int num_threads) {
  const Cells cells(model.spec());
  const Observed observed = ObservedBy(lobes, coverage, model);
  const Axis& axis = model.spec().d_axis;
  const int rings = axis.size / axis.phi_nodes;
  // The number of partial sums, each over every kSums-th ring, does not depend on the number of
  // threads.
  constexpr int kSums = 6;
  std::vector<Part> sums(kSums, {.all = 0, .light = Darkness(model)});
  ParallelFor(kSums, num_threads, [&](int k) {
    for (int ring = k; ring < rings; ring += kSums) {
      AddRing(cells, stretch, lobes, observed, model, ring, &sums[k]);
    }
  });
  Part sum = std::move(sums.front());
  for (int k = 1; k < kSums; ++k) Add(sums[k], &sum);
  return sum;
}

bool IsNearlyDiffuse(const FactorModel& model, int lobe) {
  const auto flat = [&](Factor factor, std::span<const double> table, double most) {
    double low = std::numeric_limits<double>::infinity(), high = 0;
    for (size_t i = 0; i < table.size(); ++i) {
      const double theta = model.spec().axis(factor).Theta(static_cast<int>(i));
      if (theta > DegreesToRadians(60)) continue;
      const double value = factor == Factor::kG ? table[i] / std::cos(theta) : table[i];
      low = std::min(low, value);
      high = std::max(high, value);
    }
    return high > 0 && high <= most * low;
  };
  for (int c = 0; c < kChannels; ++c) {
    if (!flat(Factor::kD, model.D(lobe, c), 2)) return false;
    if (!flat(Factor::kG, model.G(lobe, c), 1.5)) return false;
  }
  return true;
}

}  // namespace

double LobeLight::Share(int lobe) const {
  if (lobe < 0 || lobe >= static_cast<int>(lobes.size())) {
    throw Error(ErrorKind::kRange, "there is no lobe " + std::to_string(lobe) + " among " +
                                       std::to_string(lobes.size()))
        .About("lobe", lobe);
  }
  const double total = Total(*this);
  return total > 0 ? Mean(lobes[lobe]) / total : 0;
}

double LobeLight::DiffuseShare() const {
  const double total = Total(*this);
  return total > 0 ? Mean(diffuse) / total : 0;
}

LobeLight ComputeLobeLight(std::span<const double> coverage, const FactorModel& model,
                           int num_threads) {
  CheckCoverage(coverage, model);
  const ModelSpec& spec = model.spec();
  LobeLight light = Darkness(model);
  for (int m = 0; m < spec.lobes; ++m) light.nearly_diffuse.push_back(IsNearlyDiffuse(model, m));
  for (size_t k = 0; k < spec.stretches.distinct().size(); ++k) {
    std::vector<int> lobes;
    for (int m = 0; m < spec.lobes; ++m) {
      if (spec.stretches.index(m) == static_cast<int>(k)) lobes.push_back(m);
    }
    const auto [all, part] =
        PartOf(lobes, spec.stretches.distinct()[k], coverage, model, num_threads);
    // A Lambertian rho has the albedo pi rho.
    const double scale = all > 0 ? kPi / all : 0;
    for (int c = 0; c < kChannels; ++c) {
      for (const int m : lobes) light.lobes[m][c] = scale * part.lobes[m][c];
      if (k == 0) light.diffuse[c] = scale * part.diffuse[c];
    }
    for (size_t j = 0; j < light.through.size(); ++j) light.through[j] += scale * part.through[j];
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
