// Does an element-wise solver ever raise E? Looks at E after every single update, on thinned data.
// See README.md beside this file.

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "experiments/program.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/measurement/measurement.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/start/initial_model.h"

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

// What single updates have done to E.
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
  Rises rises;
  double before = start;
  SolverOptions options;
  options.max_iterations = FLAGS_sweeps;
  options.relative_decrease_tolerance = 0;
  options.diagnose = false;
  options.on_element = [&](const FactorModel& now) {
    const double after = objective.Value(now);
    rises.Add(before, after, floor);
    before = after;
  };
  const SolverSummary summary = MakeSolver(FLAGS_solver)->Solve(objective, options, &model);
  if (rises.updates == 0) throw Error(FLAGS_solver + " reports no updates of single elements");
  std::printf(
      "{\"solver\": \"%s\", \"samples\": %d, \"sweeps\": %d, \"updates\": %d, \"raised\": %d, "
      "\"worst_relative_rise\": %.3g, \"first_E\": %.17g, \"last_E\": %.17g}\n",
      FLAGS_solver.c_str(), samples.size(), summary.iterations, rises.updates, rises.raised,
      rises.worst, start, summary.final_objective);
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "monotone [--solver=awls] SOURCE", 1,
                              [](auto words) { return trilobe::Main(words[0]); });
}
