// Does an element-wise solver ever raise E? Looks at E after every single update, on thinned data,
// and counts the roots of the cubics that it solves.
// See README.md beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "core/algebra/cubic.h"
#include "core/algebra/element_step.h"
#include "experiments/program.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/value_of.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

DEFINE_string(solver, "awls", "a solver that moves single elements, or blocks of them");
DEFINE_int32(
    stride, 30,
    "of each (theta_h, theta_d) every stride-th phi_d is kept; of samples on no grid every "
    "stride-th");
DEFINE_int32(sweeps, 30, "sweeps to look at");
DEFINE_double(noise, 0.02, "relative noise of synth: sources");
DEFINE_string(weighting, "compressive", "weights of the objective");
DEFINE_bool(extrapolated, false, "of an RGL file, also take what was extrapolated");
DEFINE_double(max_angle, 90, "leave out bins whose theta_i or theta_o is beyond this, in degrees");

namespace trilobe {
namespace {

// Changes of E by single updates.
struct Rises {
  int updates = 0;
  int raised = 0;
  double worst = 0;  // largest (E after - E before) / E before

  void Add(double before, double after, double floor) {
    ++updates;
    if (after <= before) return;
    ++raised;
    worst = std::max(worst, (after - before) / std::max(before, floor));
  }
};

// A node of G that has moved.
struct MovedNode {
  int table, node;
};

// Returns the first node of G in which two models differ; nothing if they differ in none.
std::optional<MovedNode> FindMovedNode(const FactorModel& before, const FactorModel& after) {
  const ModelSpec& spec = after.spec();
  for (int t = 0; t < spec.num_tables(Factor::kG); ++t) {
    const auto was = before.table(Factor::kG, t), is = after.table(Factor::kG, t);
    const auto differs = std::ranges::mismatch(was, is);
    if (differs.in2 != is.end()) {
      return MovedNode{t, static_cast<int>(differs.in2 - is.begin())};
    }
  }
  return {};
}

// Adds up, sample by sample, how E changes with that node when all others stay (paper eqs. 5 to 7).
ElementQuartic QuarticOf(const std::vector<WeightedSample>& samples, const FactorModel& model,
                         const MovedNode& moved) {
  const ModelSpec& spec = model.spec();
  const ModelSpec::ChannelRange channels = spec.channels(Factor::kG, moved.table);
  ElementQuartic change;
  for (const WeightedSample& sample : samples) {
    const SampleStencils& at = sample.stencils;
    const double c_i = at.G_i.WeightOf(moved.node), c_o = at.G_o.WeightOf(moved.node);
    if (c_i == 0 && c_o == 0) continue;
    const ModelReads reads{model, at};
    for (int c = channels.begin; c < channels.end; ++c) {
      double p1 = 0, p2 = 0;
      for (int m = 0; m < spec.lobes; ++m) {
        if (!spec.serves(Factor::kG, moved.table, m, c)) continue;
        const Shadowing G = reads.G(m, c);
        const double y = LobeValue(reads.s(m, c), reads.D(m, c), reads.F(m, c), G.inverse_cosines);
        p1 += y * (c_i * G.o + c_o * G.i);
        p2 += y * c_i * c_o;
      }
      change.AddSample(sample.weight[c], sample.rho[c] - UnclampedValue(model, at, c), p1, p2);
    }
  }
  return change;
}

// Counts the cubics E' = 0 along nodes of G that have moved, and those of one real root. The
// polynomial has as many roots seen from where the node is now as from where it was.
struct Cubics {
  int all = 0;
  int of_one_root = 0;

  void Add(const ElementQuartic& change) {
    ++all;
    if (SolveCubic(4 * change.c4, 3 * change.c3, 2 * change.c2, change.c1).count == 1) {
      ++of_one_root;
    }
  }
};

int Main(const std::string& source) {
  const SourceOptions reading = {
      .noise = FLAGS_noise, .max_angle_deg = FLAGS_max_angle, .extrapolated = FLAGS_extrapolated};
  const Measurement measured = LoadMeasurement(source, reading);
  const BrdfSamples samples = Thinned(SamplesOf(measured), FLAGS_stride);
  const ModelSpec spec =
      measured.anisotropic ? ModelSpec::Anisotropic(3) : ModelSpec::SharedFactors(3, samples.grid);
  const Objective objective(samples, spec, FindWeighting(FLAGS_weighting));
  const double floor = ExactObjective(objective);  // below it E says nothing

  FactorModel model = InitialModels().front().make(objective, 1);
  const double start = objective.Value(model);
  const std::vector<WeightedSample> weighted = objective.weighted_samples();
  FactorModel last = model;
  Rises rises;
  Cubics cubics;
  double before = start;
  SolverOptions options;
  options.max_iterations = FLAGS_sweeps;
  options.relative_decrease_tolerance = 0;
  options.diagnose = false;
  options.on_element = [&](const FactorModel& now) {
    const double after = objective.Value(now);
    rises.Add(before, after, floor);
    before = after;
    if (const std::optional<MovedNode> moved = FindMovedNode(last, now)) {
      cubics.Add(QuarticOf(weighted, now, *moved));
    }
    last = now;
  };
  const SolverSummary summary = MakeSolver(FLAGS_solver)->Solve(objective, options, &model);
  if (rises.updates == 0) {
    throw Error(ErrorKind::kUnsupported, FLAGS_solver + " reports no updates of single elements")
        .About("solver", FLAGS_solver);
  }
  std::printf(
      "{\"solver\": \"%s\", \"samples\": %d, \"sweeps\": %d, \"updates\": %d, \"raised\": %d, "
      "\"worst_relative_rise\": %.3g, \"cubics\": %d, \"of_one_root\": %d, \"first_E\": %.17g, "
      "\"last_E\": %.17g}\n",
      FLAGS_solver.c_str(), samples.size(), summary.iterations, rises.updates, rises.raised,
      rises.worst, cubics.all, cubics.of_one_root, start, summary.final_objective);
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "monotone [--solver=awls] SOURCE", 1,
                              [](auto words) { return trilobe::Main(words[0]); });
}
