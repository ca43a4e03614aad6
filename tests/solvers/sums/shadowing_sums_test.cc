#include "solvers/sums/shadowing_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tests/test_util.h"
#include "trilobe/core/base/catmull_rom.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// A sample of weight w at two places on the spline, whose value is rest + y G(theta_i) G(theta_o).
struct SplineSample {
  CatmullRom::Location i, o;
  double w, y, measured_minus_rest;
};

std::vector<SplineSample> RandomSamples(int nodes, int count) {
  Random random(nodes);
  const auto place = [&] {
    return CatmullRom::Location{static_cast<int>(random.Uniform(0, nodes - 1)), random.Uniform()};
  };
  std::vector<SplineSample> samples;
  for (int n = 0; n < count; ++n) {
    samples.push_back(
        {place(), place(), random.LogNormal(1), random.LogNormal(1), random.LogNormal(1)});
  }
  return samples;
}

// Sweeps over the nodes twice; each goes where the quartic that is added up sample by sample has
// its minimum.
TEST(NodeQuartics, NodesGoWhereTheSamplesSendThem) {
  for (const int nodes : {4, 5, 6, 12}) {
    const CatmullRom spline(nodes);
    const std::vector<SplineSample> samples = RandomSamples(nodes, 30 * nodes);
    Random random(1);
    std::vector<double> G(nodes);
    for (double& g : G) g = random.LogNormal(0.3);

    NodeQuartics quartics(nodes);
    quartics.Clear();
    for (const SplineSample& s : samples) {
      const double r =
          s.measured_minus_rest - s.y * spline.StencilAt(s.i)(G) * spline.StencilAt(s.o)(G);
      const double w1 = s.w * s.y * r, w2 = s.w * s.y * s.y, t_i = s.i.t - 0.5, t_o = s.o.t - 0.5;
      SplineMoments moments;
      AddSplineMoments(1, &w1, &w2, &t_i, &t_o, &moments);
      NodeQuartics::CellTerms terms;
      quartics.Transform(s.i.interval, s.o.interval, moments, &terms);
      quartics.Add(s.i.interval, s.o.interval, terms);
    }

    for (int update = 0; update < 2 * nodes; ++update) {
      const int k = update % nodes;
      ElementQuartic change;
      for (const SplineSample& s : samples) {
        const Stencil at_i = spline.StencilAt(s.i), at_o = spline.StencilAt(s.o);
        const double a_i = at_i(G), a_o = at_o(G);
        const double c_i = at_i.WeightOf(k), c_o = at_o.WeightOf(k);
        change.AddSample(s.w, s.measured_minus_rest - s.y * a_i * a_o,
                         s.y * (c_i * a_o + c_o * a_i), s.y * c_i * c_o);
      }
      const double expected = BestElement(G[k], change);
      quartics.UpdateNode(k, G);
      ASSERT_NEAR(G[k], expected, 1e-9) << nodes << " nodes, update " << update;
    }
  }
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
