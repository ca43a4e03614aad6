// Fits to a part of a measurement, by several solvers and weightings from the same starts, and how
// each looks. See README.md beside this file, and that of the experiment lobes.

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/text_lines.h"
#include "core/system/process.h"
#include "experiments/program.h"
#include "model/objective/gauge.h"
#include "solvers/diagnosis.h"
#include "solvers/joint/softening.h"
#include "solvers/starts/start_elimination.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/appearance/material.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"
#include "trilobe/solvers/sums/normal_equations.h"

DEFINE_string(solvers, "auto", "a list of `trilobe solvers`, softened, lm_dogleg and searched");
DEFINE_string(weightings, "appearance", "a list of weightings of the objective");
DEFINE_string(init, "roughness", "the starts, as `trilobe fit` has them");
DEFINE_int32(starts, 1, "how many, of seeds that follow each other");
DEFINE_int32(first_start, 1, "the first seed");
DEFINE_bool(extrapolated, false, "of an RGL file, also take what was extrapolated");
DEFINE_string(corrupt, "", "as `trilobe fit` has it");
DEFINE_uint64(data_seed, 1, "of what is random in --corrupt");
DEFINE_double(max_angle, 90, "leave out bins whose theta_i or theta_o is beyond this, in degrees");
DEFINE_int32(lights, 200, "lights on the sphere that is compared");
DEFINE_int32(max_iterations, 0, "as `trilobe fit` has it; 0: its default");
DEFINE_double(tolerance, -1, "as `trilobe fit` has it; -1: its default");
DEFINE_string(models, "", "a folder for the fitted models, SOLVER-SEED.json");

namespace trilobe {
namespace {

BrdfTable Table(const std::string& source, const std::string& corrupt) {
  return LoadTable(source, {.corrupt = corrupt,
                            .seed = FLAGS_data_seed,
                            .max_angle_deg = FLAGS_max_angle,
                            .extrapolated = FLAGS_extrapolated});
}

// Objective of as many samples as `auto` uses until it has a start, though not of every other row.
Objective ThinnedObjective(const BrdfTable& table, const Weighting& weighting) {
  const BrdfSamples samples = ValidSamples(table);
  const ModelSpec spec = ModelSpec::SharedFactors(3, samples.grid);
  const Objective all(samples, spec, weighting);
  const int stride = StartElimination::StrideFor(all, StartElimination::kThinned);
  return {Thinned(all.samples(), stride), spec, weighting, /*num_threads=*/1};
}

// A solver with what stands before it.
struct Way {
  std::string solver;
  bool softened = false;  // first by stiff tables that soften
  TrustRegion trust_region = TrustRegion::kLevenbergMarquardt;
  int starts = SolverOptions().starts;
};

Way WayOf(std::string_view name) {
  if (name == "softened") return {.solver = "varpro", .softened = true};
  if (name == "searched") return {.solver = "multistart", .starts = 40};
  if (name == "lm_dogleg") return {.solver = "lm", .trust_region = TrustRegion::kDogleg};
  return {.solver = std::string(name)};
}

struct Run {
  FactorModel model;
  SolverSummary summary;
  double seconds = 0;  // processor time
};

Run FitFrom(const InitialModel& init, uint64_t seed, const Way& way, const Objective& objective) {
  SolverOptions options;
  options.diagnose = false;
  if (FLAGS_max_iterations > 0) options.max_iterations = FLAGS_max_iterations;
  if (FLAGS_tolerance >= 0) options.relative_decrease_tolerance = FLAGS_tolerance;
  options.trust_region = way.trust_region;
  options.starts = way.starts;
  const double since = ProcessorSeconds();
  FactorModel model = init.make(objective, seed);
  if (way.softened) {
    PhaseSeconds phases;
    model = Soften(
        objective, model, StiffnessSchedule(), [] { return false; }, &phases);
  }
  SolverSummary summary = MakeSolver(way.solver)->Solve(objective, options, &model);
  return {.model = model, .summary = summary, .seconds = ProcessorSeconds() - since};
}

double OptimalityOf(const Objective& objective, const FactorModel& model) {
  QuadraticModel at;
  NormalEquations(objective).Evaluate(model, Hessian::kGaussNewton, &at);
  return ScaledProjectedGradient(at, model.parameters());
}

void KeepModel(const Objective& objective, FactorModel model, const std::string& name) {
  Canonicalize(objective.coverage(), &model);
  WriteModel({.model = model, .unobserved = UnobservedParameters(objective.coverage()), .fit = {}},
             FLAGS_models + "/" + name + ".json");
}

// The largest G, in the scale of stored models.
double LargestG(FactorModel model, const Objective& objective) {
  SetCanonicalScale(objective.coverage(), &model);
  double largest = 0;
  for (int lobe = 0; lobe < model.spec().lobes; ++lobe) {
    largest = std::max(largest, std::ranges::max(model.table(Factor::kG, lobe)));
  }
  return largest;
}

// A line of JSON a fit: E of what was fitted, over a black model's, too, the latter by default
// weights of the clean samples, and the sphere beside the clean one.
int Main(const std::string& source) {
  const std::vector<std::string_view> solvers = SplitCells(FLAGS_solvers);
  for (const std::string_view name : solvers) MakeSolver(WayOf(name).solver);  // an Error soon
  const InitialModel& init = FindInitialModel(FLAGS_init);
  const BrdfTable clean_table = Table(source, "");
  const std::optional<BrdfTable> corrupted =
      FLAGS_corrupt.empty() ? std::nullopt : std::optional(Table(source, FLAGS_corrupt));
  const Objective clean = ThinnedObjective(clean_table, FindWeighting("appearance"));
  const SphereJudge judge(clean_table, {.lights = FLAGS_lights});
  for (const std::string_view name : SplitCells(FLAGS_weightings)) {
    const Weighting weighting = FindWeighting(name);
    const Objective few = ThinnedObjective(corrupted ? *corrupted : clean_table, weighting);
    for (int seed = FLAGS_first_start; seed < FLAGS_first_start + FLAGS_starts; ++seed) {
      for (const std::string_view solver : solvers) {
        const Run run = FitFrom(init, seed, WayOf(solver), few);
        const double E = run.summary.final_objective;
        const SphereError sphere = judge(MaterialOf(run.model).angular);
        std::printf(
            "{\"weighting\": \"%s\", \"seed\": %d, \"solver\": \"%s\", \"E\": %.17g, "
            "\"relative_E\": %.17g, \"clean_relative_E\": %.17g, \"psnr_db\": %.6g, "
            "\"delta_e\": %.6g, \"iterations\": %d, \"raises\": %zu, \"stop_reason\": \"%s\", "
            "\"optimality\": %.4g, \"largest_g\": %.4g, \"tried\": %zu, \"came_there\": %td, "
            "\"seconds\": %.4g}\n",
            weighting.name.c_str(), seed, std::string(solver).c_str(), E, E / few.MeasuredEnergy(),
            clean.Value(run.model) / clean.MeasuredEnergy(), sphere.psnr_db, sphere.mean_delta_e,
            run.summary.iterations, run.summary.FindRaises().iterations.size(),
            StopReasonName(run.summary.stop_reason), OptimalityOf(few, run.model),
            LargestG(run.model, few), run.summary.starts.size(),
            std::ranges::count(run.summary.starts, 1, &StartResult::minimum), run.seconds);
        std::fflush(stdout);
        if (!FLAGS_models.empty()) {
          KeepModel(few, run.model, std::string(solver) + "-" + std::to_string(seed));
        }
      }
    }
  }
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "thinned_fits [--solvers=NAME,...] SOURCE", 1,
                              [](auto words) { return trilobe::Main(words[0]); });
}
