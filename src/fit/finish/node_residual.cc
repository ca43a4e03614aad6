#include "fit/finish/node_residual.h"

#include <cstddef>
#include <utility>
#include <vector>

#include "trilobe/core/base/error.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/model/objective/reconstruct.h"

namespace trilobe {
namespace {

// The mean over the 16 pairs that are a step of all four angles away from nodes i and o; nothing
// where one of them is missing.
std::optional<Rgb> MeanAround(const NodeTable& table, int i, int o) {
  const HemisphereGrid& grid = table.grid;
  const auto neighbour = [&](int node, int k) {
    const int theta = node / grid.phis + ((k & 1) != 0 ? 1 : -1);
    const int phi = (node % grid.phis + ((k & 2) != 0 ? 1 : grid.phis - 1)) % grid.phis;
    return theta < 0 || theta >= grid.thetas ? -1 : theta * grid.phis + phi;
  };
  Rgb mean{};
  for (int k = 0; k < 16; ++k) {
    const int a = neighbour(i, k), b = neighbour(o, k >> 2);
    if (a < 0 || b < 0) return std::nullopt;
    const size_t index = static_cast<size_t>(a) * grid.nodes() + b;
    if (!table.present[index]) return std::nullopt;
    for (int c = 0; c < kChannels; ++c) mean[c] += table.rho[index][c] / 16;
  }
  return mean;
}

// `sample`: the data's at each pair of nodes, or -1.
bool CanBeInterpolated(const NodeTable& residual, const std::vector<int>& sample,
                       const Objective& data) {
  struct Sum {
    double all = 0, left = 0;
  };
  const int nodes = residual.grid.nodes();
  std::vector<Sum> sums(nodes);
  ParallelFor(nodes, data.num_threads(), [&](int i) {
    for (int o = 0; o < nodes; ++o) {
      const size_t index = static_cast<size_t>(i) * nodes + o;
      if (!residual.present[index]) continue;
      const std::optional<Rgb> around = MeanAround(residual, i, o);
      if (!around) continue;
      const Rgb weight = data.Sample(sample[index]).weight;
      for (int c = 0; c < kChannels; ++c) {
        const double here = residual.rho[index][c], left = here - (*around)[c];
        sums[i].all += weight[c] * here * here;
        sums[i].left += weight[c] * left * left;
      }
    }
  });
  Sum total;
  for (const Sum& sum : sums) {
    total.all += sum.all;
    total.left += sum.left;
  }
  return total.left < total.all;
}

}  // namespace

std::optional<NodeBrdf> InterpolateResidual(const FactorModel& model, const Objective& data,
                                            const HemisphereGrid& grid) {
  CheckHemisphereGrid(grid);
  const BrdfSamples& measured = data.samples();
  const auto nodes = static_cast<size_t>(grid.nodes());
  NodeTable residual{.source = measured.source,
                     .grid = grid,
                     .rho = std::vector<Rgb>(nodes * nodes),
                     .present = std::vector<bool>(nodes * nodes)};
  std::vector<int> sample(nodes * nodes, -1);
  const std::vector<Rgb> of_model = EvaluateSamples(model, measured, data.num_threads());
  for (int j = 0; j < measured.size(); ++j) {
    const SphericalAngles& at = measured.directions[j];
    const auto i = grid.Find(at.theta_i, at.phi_i), o = grid.Find(at.theta_o, at.phi_o);
    if (!i || !o) {
      throw ErrorIn(ErrorKind::kMismatch, measured.source,
                    "a sample is at no node of the prior's grid")
          .About("grid");
    }
    const size_t index = *i * nodes + *o;
    residual.present[index] = true;
    sample[index] = j;
    for (int c = 0; c < kChannels; ++c) {
      residual.rho[index][c] = measured.rho[j][c] - of_model[j][c];
    }
  }
  if (!CanBeInterpolated(residual, sample, data)) return std::nullopt;
  return NodeBrdf(std::move(residual));
}

}  // namespace trilobe
