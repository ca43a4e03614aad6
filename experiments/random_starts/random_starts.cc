// Fits from many random starts to a part of a measurement: what each solver makes of the same ones.
// See README.md beside this file.

#include <gflags/gflags.h>

#include <cstdio>
#include <ctime>
#include <string>

#include "experiments/program.h"
#include "solvers/multistart/start_elimination.h"
#include "solvers/smooth/softening.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/start/initial_model.h"

DEFINE_string(solver, "auto", "one of `trilobe solvers`");
DEFINE_bool(dogleg, false, "of lm, take dogleg steps");
DEFINE_bool(softened, false, "lead each start by stiff tables that soften, then by the solver");
DEFINE_string(init, "roughness", "the starts, as `trilobe fit` has them");
DEFINE_int32(starts, 20, "how many");
DEFINE_int32(first_seed, 1, "seed of the first; those of the others follow");
DEFINE_string(weighting, "appearance", "weights of the objective");
DEFINE_bool(extrapolated, false, "of an RGL file, also take what was extrapolated");
DEFINE_string(corrupt, "", "as `trilobe fit` has it");
DEFINE_uint64(data_seed, 1, "of what is random in --corrupt");
DEFINE_double(max_angle, 90, "leave out bins whose theta_i or theta_o is beyond this, in degrees");
DEFINE_int32(lights, 200, "lights on the sphere that is compared");

namespace trilobe {
namespace {

BrdfTable Table(const std::string& source, const std::string& corrupt) {
  return LoadTable(source, {.corrupt = corrupt,
                            .seed = FLAGS_data_seed,
                            .max_angle_deg = FLAGS_max_angle,
                            .extrapolated = FLAGS_extrapolated});
}

// As many samples as `auto` looks at before it has a start, though not of every other row.
Objective ThinnedObjective(const BrdfTable& table) {
  const BrdfSamples samples = ValidSamples(table);
  const ModelSpec spec = ModelSpec::SharedFactors(3, samples.grid);
  const Weighting weighting = FindWeighting(FLAGS_weighting);
  const Objective all(samples, spec, weighting);
  const int stride = StartElimination::StrideFor(all, StartElimination::kThinned);
  return {Thinned(all.samples(), stride), spec, weighting, /*num_threads=*/1};
}

double ProcessorSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// A line of JSON a start: E of what was fitted, over a black model's, too, of the clean samples
// (the same unless --corrupt), and the sphere beside the clean one.
int Main(const std::string& source) {
  const BrdfTable clean_table = Table(source, "");
  const Objective clean = ThinnedObjective(clean_table);
  const Objective few =
      FLAGS_corrupt.empty() ? clean : ThinnedObjective(Table(source, FLAGS_corrupt));
  const SphereJudge judge(clean_table, {.lights = FLAGS_lights});
  SolverOptions options;
  options.diagnose = false;
  if (FLAGS_dogleg) options.trust_region = TrustRegion::kDogleg;
  const InitialModel& init = FindInitialModel(FLAGS_init);
  for (int seed = FLAGS_first_seed; seed < FLAGS_first_seed + FLAGS_starts; ++seed) {
    const double since = ProcessorSeconds();
    FactorModel model = init.make(few, seed);
    if (FLAGS_softened) {
      PhaseSeconds phases;
      model = Soften(
          few, model, StiffnessSchedule(), [] { return false; }, &phases);
    }
    const SolverSummary summary = MakeSolver(FLAGS_solver)->Solve(few, options, &model);
    const double seconds = ProcessorSeconds() - since;
    const SphereError sphere = judge(MaterialOf(model).angular);
    std::printf(
        "{\"seed\": %d, \"E\": %.17g, \"relative_E\": %.17g, \"clean_relative_E\": %.17g, "
        "\"psnr_db\": %.6g, \"delta_e\": %.6g, \"iterations\": %d, \"raises\": %zu, "
        "\"stop_reason\": \"%s\", \"seconds\": %.4g}\n",
        seed, summary.final_objective, summary.final_objective / few.MeasuredEnergy(),
        clean.Value(model) / clean.MeasuredEnergy(), sphere.psnr_db, sphere.mean_delta_e,
        summary.iterations, summary.FindRaises().iterations.size(),
        StopReasonName(summary.stop_reason), seconds);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "random_starts [--solver=NAME] SOURCE", 1,
                              [](auto words) { return trilobe::Main(words[0]); });
}
