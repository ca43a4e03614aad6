#include "trilobe/fit/finish/node_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/system/process.h"
#include "fit/finish/search.h"
#include "model/objective/lobes.h"
#include "trilobe/core/base/check.h"
#include "trilobe/core/base/directions.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/finish/synthetic_prior.h"
#include "trilobe/solvers/solver.h"
#include "trilobe/solvers/starts/initial_model.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

constexpr int kOneOf = 5;              // pairs of directions of which one is held out
constexpr int kFirstIterations = 12;   // from the starting point
constexpr int kFurtherIterations = 6;  // from the fit on coarser nodes

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
uint64_t Mix(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

// Hash of the vector, rounded to 1e-6, in which all azimuths of the normal are one direction.
uint64_t HashOf(const Direction& direction, uint64_t seed) {
  uint64_t hash = seed;
  for (const double x : direction) {
    hash = Mix(hash + 0x9e3779b97f4a7c15U + static_cast<uint64_t>(std::llround(1e6 * x)));
  }
  return hash;
}

std::string Nodes(int rings, const char* steps, int phis) {
  return std::to_string(rings) + steps + "x" + std::to_string(phis);
}

}  // namespace

std::vector<FormSpec> NodeLadder(const ModelSpec& spec, int thetas, int phis) {
  struct Rung {
    int d_rings, d_phis, g_rings, g_phis;
  };
  constexpr Rung kRungs[] = {
      {8, 24, 6, 16}, {12, 36, 6, 24}, {16, 48, 6, 32}, {20, 60, 8, 40}, {24, 72, 10, 48}};
  std::vector<FormSpec> ladder;
  for (const Rung& rung : kRungs) {
    const int d_phis = std::clamp(phis, 4, rung.d_phis);
    const int g_rings = std::clamp(thetas, 6, rung.g_rings);
    const int g_phis = std::clamp(phis / 2, 4, rung.g_phis);
    FormSpec candidate = {
        .name = "D " + Nodes(rung.d_rings, "r", d_phis) + ", G " + Nodes(g_rings, "", g_phis),
        .spec = spec};
    candidate.spec.d_axis = Axis::EvenPolar(rung.d_rings, Axis::Steps::kOfRoot, d_phis);
    candidate.spec.g_axis = Axis::EvenPolar(g_rings, Axis::Steps::kOfTheta, g_phis);
    if (spec.g_axis.reaches_horizon()) candidate.spec.g_axis = candidate.spec.g_axis.ToHorizon();
    ladder.push_back(std::move(candidate));
  }
  return ladder;
}

std::vector<bool> HeldOut(const BrdfSamples& samples, uint64_t seed) {
  if (samples.directions.empty()) {
    throw ErrorIn(ErrorKind::kMissing, samples.source,
                  "to hold out directions, samples must know theirs")
        .About("directions");
  }
  std::vector<bool> held_out;
  held_out.reserve(samples.directions.size());
  for (const SphericalAngles& at : samples.directions) {
    const auto [wi, wo] = ToDirections(at);
    const auto [first, second] = std::minmax({HashOf(wi, seed), HashOf(wo, seed)});
    held_out.push_back(Mix(first + Mix(second)) % kOneOf == 0);
  }
  return held_out;
}

NodeChoice ChooseNodes(const Objective& data, const std::vector<FormSpec>& ladder,
                       const NodeChoiceOptions& options) {
  const Stopwatch since;
  const BrdfSamples& samples = data.samples();
  if (ladder.empty()) {
    throw ErrorIn(ErrorKind::kMissing, samples.source, "no nodes to choose from").About("nodes");
  }
  CheckNumber("prior", options.prior, options.prior >= 0 && std::isfinite(options.prior),
              "finite and 0 or more");
  CheckNumber("worthwhile", options.worthwhile, options.worthwhile > 0 && options.worthwhile <= 1,
              "above 0 and at most 1");
  std::vector<int> kept, held;
  const std::vector<bool> held_out = HeldOut(samples, options.seed);
  for (int j = 0; j < samples.size(); ++j) (held_out[j] ? held : kept).push_back(j);
  if (kept.empty() || held.empty()) {
    throw ErrorIn(ErrorKind::kData, samples.source,
                  "too few directions to hold out a fifth of them; give nodes")
        .About("directions", samples.size());
  }
  const int threads = data.num_threads();
  const auto objective_of = [&](BrdfSamples part) {
    return Objective(std::move(part), ladder[0].spec, data.weighting(), threads);
  };
  const Objective held_back = objective_of(Selected(samples, held));
  const auto relative_E = [&](const FactorModel& model) {
    const Objective judged(held_back, model.spec());
    return judged.Value(model) / judged.MeasuredEnergy();
  };
  double E = 0;  // relative, of the model that is judged
  Search search([&E](const FactorModel& /*model*/) { return -10 * std::log10(E); },
                {.over_leader = -10 * std::log10(options.worthwhile)});
  Objective fitted = objective_of(Selected(samples, kept));
  if (options.prior > 0) {
    fitted = Objective(
        fitted,
        WithPrior(fitted, {.weight = options.prior, .grid = options.grid, .stop = options.stop}));
  }
  std::optional<FactorModel> model;
  NodeChoice choice = {.model = FactorModel(ladder[0].spec),
                       .held_out = held_back.samples().size()};
  for (const FormSpec& rung : ladder) {
    const Objective objective(fitted, rung.spec);
    SolverOptions solver;
    solver.max_iterations = model ? kFurtherIterations : kFirstIterations;
    solver.relative_decrease_tolerance = 1e-3;
    solver.diagnose = false;
    solver.on_iteration = options.on_iteration;
    solver.stop = options.stop;
    model =
        model ? WithAxes(*model, rung.spec) : InitialModels().front().make(objective, options.seed);
    const SolverSummary summary = MakeSolver("varpro")->Solve(objective, solver, &*model);
    E = relative_E(*model);
    search.Try(rung.name, *model, rung.spec.num_parameters(), E);
    const bool interrupted = summary.stop_reason == StopReason::kInterrupted;
    // An interrupted fit says nothing against the candidate before.
    if (search.has_leader() && (interrupted || !search.LastLeads())) break;
    search.TakeLast();
    choice.model = *model;
    if (interrupted) break;
  }
  choice.tried = search.candidates();
  choice.chosen = search.chosen();
  choice.seconds = since.Seconds();
  return choice;
}

}  // namespace trilobe
