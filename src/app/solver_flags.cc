#include "trilobe/app/solver_flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <initializer_list>
#include <stdexcept>

#include "trilobe/app/flags.h"
#include "trilobe/base/error.h"

namespace {

const trilobe::SolverOptions kDefaults;

}  // namespace

DEFINE_string(solver, trilobe::Solvers().front().name, "one of the solvers above");
DEFINE_int32(max_iterations, kDefaults.max_iterations,
             "stop after this many iterations (for AWLS, sweeps)");
DEFINE_double(max_seconds, 0, "stop after the iteration in which this time is up; 0 for no limit");
DEFINE_double(tolerance, kDefaults.relative_decrease_tolerance,
              "stop when an iteration changes E by less than this fraction of it");
DEFINE_double(optimality_tolerance, kDefaults.optimality_tolerance,
              "stop when the scaled projected gradient is at most this, where the solver knows it");
DEFINE_bool(diagnose, kDefaults.diagnose,
            "report the optimality, rank and condition of the result; --nodiagnose saves the time");
DEFINE_double(g_filter, 0,
              "standard deviation, in degrees, of a Gaussian filter on G after each sweep, which "
              "may raise E; 0 for none");
DEFINE_string(positivity, trilobe::PositivityName(kDefaults.positivity),
              "how parameters are kept >= 0: active_set, bounds or squares");
DEFINE_string(trust_region, trilobe::TrustRegionName(kDefaults.trust_region),
              "how the length of a step is bounded: levenberg_marquardt or dogleg");
DEFINE_int32(memory, kDefaults.memory, "earlier iterates that an accelerated solver combines");
DEFINE_int32(starts, kDefaults.starts, "starting points to try, that of --init among them");

namespace trilobe {
namespace {

// The flag that stands for a member of SolverOptions that only some solvers read.
struct ParticularFlag {
  const char* member;
  const char* flag;
};
constexpr ParticularFlag kParticularFlags[] = {
    {"g_filter_sigma", "g_filter"}, {"positivity", "positivity"}, {"trust_region", "trust_region"},
    {"memory", "memory"},           {"starts", "starts"},         {"seed", "seed"}};

// Has other uses too, so it is no mistake where the solver does not read it.
bool IsShared(const std::string& flag) { return flag == "seed"; }

std::vector<std::string> FlagsOf(const SolverEntry& solver) {
  std::vector<std::string> flags;
  for (const std::string& member : solver.options) {
    const auto* const found = std::ranges::find(kParticularFlags, member, &ParticularFlag::member);
    if (found == std::end(kParticularFlags)) {
      throw std::logic_error("solver " + solver.name + " reads the option " + member +
                             ", for which there is no flag");
    }
    flags.emplace_back(found->flag);
  }
  return flags;
}

void CheckThatSolverTakesFlags(const SolverEntry& solver) {
  const std::vector<std::string> taken = FlagsOf(solver);
  for (const std::string& flag : ParticularSolverFlags()) {
    if (IsDefault(flag) || std::ranges::find(taken, flag) != taken.end()) continue;
    std::string others;
    for (const std::string& other : taken) others += (others.empty() ? "--" : ", --") + other;
    throw Error("solver " + solver.name + " does not take --" + flag + "; " +
                (others.empty() ? "it has no flags of its own" : "it takes " + others) +
                "; see `trilobe solvers`");
  }
}

// The choice that the text names.
template <typename Choice>
Choice FindChoice(const std::string& flag, const std::string& text,
                  std::initializer_list<Choice> choices, const char* (*name)(Choice)) {
  std::string known;
  for (const Choice choice : choices) {
    if (text == name(choice)) return choice;
    known += (known.empty() ? "" : ", ") + std::string(name(choice));
  }
  throw Error("unknown --" + flag + "=" + text + "; known: " + known);
}

}  // namespace

const SolverEntry& SolverFromFlags() { return FindSolver(FLAGS_solver); }

std::vector<std::string> CommonSolverFlags() {
  return {"max_iterations", "max_seconds", "tolerance", "optimality_tolerance", "diagnose"};
}

std::vector<std::string> ParticularSolverFlags() {
  std::vector<std::string> flags;
  for (const ParticularFlag& entry : kParticularFlags) {
    if (!IsShared(entry.flag)) flags.emplace_back(entry.flag);
  }
  return flags;
}

SolverOptions SolverOptionsFromFlags(const SolverEntry& solver, const ModelSpec& spec) {
  CheckThatSolverTakesFlags(solver);
  if (FLAGS_max_iterations < 0) throw Error("--max_iterations is negative; give 0 or more");
  if (!(FLAGS_max_seconds >= 0)) throw Error("--max_seconds must be a number >= 0; 0 is no limit");
  if (!(FLAGS_tolerance >= 0 && FLAGS_tolerance < 1)) {
    throw Error("--tolerance must be at least 0 and below 1");
  }
  if (!(FLAGS_optimality_tolerance >= 0 && FLAGS_optimality_tolerance < 1)) {
    throw Error("--optimality_tolerance must be at least 0 and below 1");
  }
  if (!(FLAGS_g_filter >= 0 && FLAGS_g_filter <= 90)) {
    throw Error("--g_filter must be from 0 to 90 degrees");
  }
  if (FLAGS_memory < 0) throw Error("--memory is negative; give 0 or more");
  if (FLAGS_starts < 1) throw Error("--starts must be at least 1");
  SolverOptions options;
  options.max_iterations = FLAGS_max_iterations;
  if (FLAGS_max_seconds > 0) options.max_seconds = FLAGS_max_seconds;
  options.relative_decrease_tolerance = FLAGS_tolerance;
  options.optimality_tolerance = FLAGS_optimality_tolerance;
  options.diagnose = FLAGS_diagnose;
  options.g_filter_sigma = FLAGS_g_filter * spec.g_axis.size / 90;
  options.positivity = FindChoice(
      "positivity", FLAGS_positivity,
      {Positivity::kActiveSet, Positivity::kBounds, Positivity::kSquares}, PositivityName);
  options.trust_region =
      FindChoice("trust_region", FLAGS_trust_region,
                 {TrustRegion::kLevenbergMarquardt, TrustRegion::kDogleg}, TrustRegionName);
  options.memory = FLAGS_memory;
  options.starts = FLAGS_starts;
  options.seed = static_cast<uint64_t>(FLAGS_seed);
  return options;
}

std::string DescribeSolver(const SolverEntry& solver) {
  std::string text = "solver " + solver.name + ": " + solver.description +
                     "\n  reference: " + solver.reference + "\n";
  const std::vector<std::string> flags = FlagsOf(solver);
  if (flags.empty()) return text + "  no flags of its own\n";
  text += "flags of solver " + solver.name + ":\n";
  for (const std::string& flag : flags) text += FlagHelp(flag);
  return text;
}

}  // namespace trilobe
