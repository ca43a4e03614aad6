// How often, and how soon, does one random start come to the lowest E, by how stiff tables are to
// begin with and how they soften? See README.md beside this file.

#include "solvers/smooth/softening.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <optional>
#include <random>
#include <string>

#include "experiments/program.h"
#include "solvers/multistart/start_elimination.h"
#include "trilobe/core/base/error.h"
#include "trilobe/io/formats/source.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/registry/solvers.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/start/initial_model.h"

DEFINE_string(way, "from_1e-4", "what a start goes through: one of the names in `kWays`");
DEFINE_int32(starts, 100, "random starts");
DEFINE_int32(first_seed, 1, "seed of the first; those of the others follow");
DEFINE_string(weighting, "appearance", "weights of the objective");
DEFINE_bool(extrapolated, false, "of an RGL file, also take what was extrapolated");
DEFINE_string(corrupt, "", "as `trilobe fit` has it");
DEFINE_uint64(seed, 1, "of what is random in --corrupt");
DEFINE_double(max_angle, 90, "leave out bins whose theta_i or theta_o is beyond this, in degrees");

namespace trilobe {
namespace {

// Where a start is led, by stiff tables or not, and the solver that then goes on to a minimum of E.
struct Way {
  const char* name;
  std::optional<StiffnessSchedule> schedule;
  const char* solver = "varpro";
};

const Way kWays[] = {
    {.name = "none", .schedule = std::nullopt},
    {.name = "sweeps", .schedule = std::nullopt, .solver = "hybrid"},
    {.name = "always_1e-9", .schedule = StiffnessSchedule{.stiffest = 1e-9}},
    {.name = "from_1e-3", .schedule = StiffnessSchedule{.stiffest = 1e-3}},
    {.name = "from_1e-4", .schedule = StiffnessSchedule{}},
    {.name = "from_1e-5", .schedule = StiffnessSchedule{.stiffest = 1e-5}},
    {.name = "from_1e-4_by_10", .schedule = StiffnessSchedule{.factor = 10}},
    {.name = "from_1e-4_slopes_too", .schedule = StiffnessSchedule{.slope = 0.1}},
    {.name = "auto", .schedule = std::nullopt, .solver = "auto"},
};

const Way& FindWay(const std::string& name) {
  const auto* const found =
      std::ranges::find_if(kWays, [&](const Way& way) { return way.name == name; });
  if (found != std::end(kWays)) return *found;
  std::string known;
  for (const Way& way : kWays) known += std::string(known.empty() ? "" : ", ") + way.name;
  throw Error("--way=" + name + ": there are " + known);
}

// GGX lobes that fit nothing and reflect alike, roughness spread between two random values.
FactorModel RandomStart(const Objective& objective, int seed) {
  std::mt19937_64 random(seed);
  const auto roughness = [&random] {
    constexpr double kNarrow = 0.02, kWide = 0.6;
    const double u = static_cast<double>(random() >> 11) * 0x1p-53;
    return kNarrow * std::pow(kWide / kNarrow, u);
  };
  const double one = roughness(), other = roughness();
  return SpreadModel(objective, std::min(one, other), std::max(one, other));
}

// As many as `auto` looks at before it has a start, though not of every other row.
Objective ThinnedObjective(const std::string& source, const SourceOptions& reading) {
  const BrdfSamples samples = ValidSamples(LoadTable(source, reading));
  const ModelSpec spec = ModelSpec::SharedFactors(3, samples.grid);
  const Weighting& weighting = FindWeighting(FLAGS_weighting);
  const Objective all(samples, spec, weighting);
  const int stride = StartElimination::StrideFor(all, StartElimination::kThinned);
  return {Thinned(all.samples(), stride), spec, weighting, /*num_threads=*/1};
}

double ProcessorSeconds() {
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

int Main(const std::string& source) {
  const Way& way = FindWay(FLAGS_way);
  const Objective few = ThinnedObjective(source, {.corrupt = FLAGS_corrupt,
                                                  .seed = FLAGS_seed,
                                                  .max_angle_deg = FLAGS_max_angle,
                                                  .extrapolated = FLAGS_extrapolated});
  SolverOptions options;
  options.diagnose = false;
  for (int seed = FLAGS_first_seed; seed < FLAGS_first_seed + FLAGS_starts; ++seed) {
    const double since = ProcessorSeconds();
    PhaseSeconds phases;
    FactorModel model = RandomStart(few, seed);
    if (way.schedule) {
      model = Soften(
          few, model, *way.schedule, [] { return false; }, &phases);
    }
    const SolverSummary summary = MakeSolver(way.solver)->Solve(few, options, &model);
    std::printf("{\"seed\": %d, \"E\": %.17g, \"relative_E\": %.17g, \"seconds\": %.4g}\n", seed,
                summary.final_objective, summary.final_objective / few.MeasuredEnergy(),
                ProcessorSeconds() - since);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace trilobe

int main(int argc, char** argv) {
  return trilobe::ProgramMain(argc, argv, "softening [--way=NAME] SOURCE", 1,
                              [](auto words) { return trilobe::Main(words[0]); });
}
