#include "trilobe/solvers/solver_options.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/base/names.h"
#include "trilobe/core/base/error.h"

namespace trilobe {
namespace {

template <typename Choice>
struct NamedChoice {
  const char* name;
  Choice choice;
};

// All that there are of a type of choice, the value of which does not matter.
const std::vector<NamedChoice<Positivity>>& ChoicesLike(Positivity) {
  static const std::vector<NamedChoice<Positivity>> choices = {
      {"active_set", Positivity::kActiveSet}, {"bounds", Positivity::kBounds}};
  return choices;
}
const std::vector<NamedChoice<TrustRegion>>& ChoicesLike(TrustRegion) {
  static const std::vector<NamedChoice<TrustRegion>> choices = {
      {"levenberg_marquardt", TrustRegion::kLevenbergMarquardt}, {"dogleg", TrustRegion::kDogleg}};
  return choices;
}
const std::vector<NamedChoice<LinearSolver>>& ChoicesLike(LinearSolver) {
  static const std::vector<NamedChoice<LinearSolver>> choices = {
      {"auto", LinearSolver::kAuto},
      {"dense_qr", LinearSolver::kDenseQr},
      {"dense_normal_cholesky", LinearSolver::kDenseNormalCholesky},
      {"sparse_normal_cholesky", LinearSolver::kSparseNormalCholesky},
      {"dense_schur", LinearSolver::kDenseSchur},
      {"sparse_schur", LinearSolver::kSparseSchur},
      {"iterative_schur", LinearSolver::kIterativeSchur},
      {"cgnr", LinearSolver::kCgnr}};
  return choices;
}

template <typename Choice>
const char* NameOf(Choice choice) {
  return std::ranges::find(ChoicesLike(choice), choice, &NamedChoice<Choice>::choice)->name;
}

// "active_set, bounds or squares"
template <typename Choice>
std::string NamesLike(Choice choice) {
  std::string text;
  const auto& choices = ChoicesLike(choice);
  for (size_t k = 0; k < choices.size(); ++k) {
    text += k == 0 ? "" : k + 1 < choices.size() ? ", " : " or ";
    text += choices[k].name;
  }
  return text;
}

// The option that is this member. Choices are listed at the end of its help.
template <typename T>
SolverOption Option(const char* name, T SolverOptions::*member, SolverOption option) {
  option.name = name;
  if (option.flag.empty()) option.flag = name;
  if constexpr (std::is_enum_v<T>) {
    option.help += ": " + NamesLike(T());
    option.get = [member](const SolverOptions& options) { return NameOf(options.*member); };
    option.set = [member, name](const OptionValue& value, SolverOptions* options) {
      options->*member = FindNamed(name, std::get<std::string>(value), ChoicesLike(T())).choice;
    };
  } else {
    option.get = [member](const SolverOptions& options) { return options.*member; };
    option.set = [member](const OptionValue& value, SolverOptions* options) {
      options->*member = std::get<T>(value);
    };
  }
  return option;
}

constexpr OptionRange kNumber = {"a number", [](double x) { return !std::isnan(x); }};
constexpr OptionRange kNotNegative = {"0 or more", [](double x) { return x >= 0; }};
constexpr OptionRange kAtLeastOne = {"1 or more", [](double x) { return x >= 1; }};
constexpr OptionRange kFiniteNotNegative = {"finite and 0 or more",
                                            [](double x) { return x >= 0 && std::isfinite(x); }};
constexpr OptionRange kFraction = {"at least 0 and below 1",
                                   [](double x) { return x >= 0 && x < 1; }};
constexpr OptionRange kRightAngle = {"from 0 to 90 degrees",
                                     [](double x) { return x >= 0 && x <= 90; }};

std::vector<SolverOption> MakeOptions() {
  using Options = SolverOptions;
  const Options defaults;
  return {
      Option("max_iterations", &Options::max_iterations,
             {.common = true,
              .help = "stop after this many iterations (for AWLS, sweeps)",
              .range = kNotNegative}),
      Option("max_seconds", &Options::max_seconds,
             {.common = true,
              .help = "stop the solver after the iteration in which this time is up, before the "
                      "finishing and the pictures; 0 for no limit",
              .range = kNotNegative,
              .unit = {{.default_value = 0,
                        .range = kNotNegative,
                        .to_member =
                            [](double seconds, const ModelSpec&) {
                              return seconds > 0 ? seconds : Options().max_seconds;
                            }}}}),
      Option(
          "relative_decrease_tolerance", &Options::relative_decrease_tolerance,
          {.common = true,
           .flag = "tolerance",
           .help = "stop when an iteration changes E by less than this fraction of it",
           .range = kNumber,  // below 0: never
           .unit = {{.default_value = defaults.relative_decrease_tolerance, .range = kFraction}}}),
      Option("optimality_tolerance", &Options::optimality_tolerance,
             {.common = true,
              .help = "stop when the scaled projected gradient is at most this, where the solver "
                      "knows it",
              .range = kNotNegative,
              .unit = {{.default_value = defaults.optimality_tolerance, .range = kFraction}}}),
      Option("diagnose", &Options::diagnose,
             {.common = true,
              .help = "report the optimality, rank and condition of the result; --nodiagnose saves "
                      "the time"}),
      Option("g_filter_sigma", &Options::g_filter_sigma,
             {.flag = "g_filter",
              .help = "standard deviation, in degrees, of a Gaussian filter on G after each sweep, "
                      "which may raise E; 0 for none",
              .range = kFiniteNotNegative,
              .unit = {{.default_value = 0,
                        .range = kRightAngle,
                        .to_member =
                            [](double degrees, const ModelSpec& spec) {
                              return degrees * spec.g_axis.size / 90;
                            }}}}),
      Option("positivity", &Options::positivity, {.help = "how parameters are kept >= 0"}),
      Option("trust_region", &Options::trust_region,
             {.help = "how the length of a step is bounded"}),
      Option("nonmonotonic", &Options::nonmonotonic,
             {.help = "judge a step of the trust region against up to five steps before, not the "
                      "last alone"}),
      Option(
          "linear_solver", &Options::linear_solver,
          {.help = "how Ceres solves for a step (auto takes dense_qr where the Jacobian has at "
                   "most 64 MiB, else sparse_normal_cholesky; a Schur complement eliminates D)"}),
      Option("inner_iterations", &Options::inner_iterations,
             {.help = "after each step of Ceres, minimise E over one parameter block after another "
                      "(Ruhe and Wedin's algorithm II)"}),
      Option(
          "memory", &Options::memory,
          {.help = "earlier iterates that an accelerated solver combines", .range = kNotNegative}),
      Option("starts", &Options::starts,
             {.help = "starting points to try, that of --init among them", .range = kAtLeastOne}),
      Option("seed", &Options::seed, {})};
}

}  // namespace

const char* PositivityName(Positivity positivity) { return NameOf(positivity); }

const char* TrustRegionName(TrustRegion trust_region) { return NameOf(trust_region); }

const char* LinearSolverName(LinearSolver linear_solver) { return NameOf(linear_solver); }

const std::vector<SolverOption>& AllSolverOptions() {
  static const std::vector<SolverOption> options = MakeOptions();
  return options;
}

const SolverOption& FindSolverOption(std::string_view name) {
  return FindNamed("option of solvers", name, AllSolverOptions());
}

std::vector<const SolverOption*> OptionsReadBy(std::span<const std::string> particular) {
  std::vector<const SolverOption*> read;
  for (const SolverOption& option : AllSolverOptions()) {
    if (option.common || std::ranges::count(particular, option.name) > 0) read.push_back(&option);
  }
  return read;
}

void CheckSolverOptions(const SolverOptions& options) {
  for (const SolverOption& option : AllSolverOptions()) {
    CheckInRange(option.name, option.get(options), option.range);
  }
}

}  // namespace trilobe
