#include "app/solver_flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <utility>
#include <variant>

#include "app/flags.h"
#include "app/help.h"
#include "trilobe/core/base/error.h"
#include "trilobe/solvers/starts/solvers.h"

namespace trilobe {
namespace {

// The program has such a flag (flags.h) for other uses, too, so that it is no mistake where the
// solver does not read it.
bool IsShared(const SolverOption& option) { return option.help.empty(); }

std::vector<std::string> FlagsOf(const SolverEntry& solver) {
  std::vector<std::string> flags;
  for (const std::string& name : solver.options) flags.push_back(FindSolverOption(name).flag);
  return flags;
}

void CheckThatSolverTakesFlags(const SolverEntry& solver) {
  const std::vector<std::string> taken = FlagsOf(solver);
  for (const std::string& flag : ParticularSolverFlags()) {
    if (IsDefault(flag) || std::ranges::find(taken, flag) != taken.end()) continue;
    std::string others;
    for (const std::string& other : taken) others += (others.empty() ? "--" : ", --") + other;
    throw Error(ErrorKind::kUnsupported,
                "solver " + solver.name + " does not take --" + flag + "; " +
                    (others.empty() ? "it has no flags of its own" : "it takes " + others) +
                    "; see `trilobe solvers`")
        .About(flag);
  }
}

void SetOption(const SolverOption& option, OptionValue value, const ModelSpec& spec,
               SolverOptions* options) {
  const std::string flag = "--" + option.flag;
  if (option.unit) {
    CheckInRange(flag, value, option.unit->range);
    if (option.unit->to_member) value = option.unit->to_member(std::get<double>(value), spec);
  }
  CheckInRange(flag, value, option.range);
  option.set(value, options);
}

}  // namespace

void DefineSolverFlags() {
  for (const SolverOption& option : AllSolverOptions()) {
    if (IsShared(option)) continue;
    DefineFlag(option.flag, option.help,
               option.unit ? option.unit->default_value : option.get(SolverOptions()));
  }
}

const SolverEntry& SolverFromFlags() { return FindSolver(TextFlag("solver")); }

std::vector<std::string> CommonSolverFlags() {
  std::vector<std::string> flags;
  for (const SolverOption* option : OptionsReadBy({})) flags.push_back(option->flag);
  return flags;
}

std::vector<std::string> ParticularSolverFlags() {
  std::vector<std::string> flags;
  for (const SolverOption& option : AllSolverOptions()) {
    if (!option.common && !IsShared(option)) flags.push_back(option.flag);
  }
  return flags;
}

std::function<SolverOptions(const ModelSpec&)> SolverOptionsByFlags(const SolverEntry& solver) {
  CheckThatSolverTakesFlags(solver);
  std::vector<std::pair<const SolverOption*, OptionValue>> values;
  for (const SolverOption& option : AllSolverOptions()) {
    if (!IsShared(option)) values.emplace_back(&option, FlagValue(option.flag));
  }
  return [values, seed = static_cast<uint64_t>(FLAGS_seed)](const ModelSpec& spec) {
    SolverOptions options;
    for (const auto& [option, value] : values) SetOption(*option, value, spec, &options);
    options.seed = seed;
    return options;
  };
}

SolverOptions SolverOptionsFromFlags(const SolverEntry& solver, const ModelSpec& spec) {
  return SolverOptionsByFlags(solver)(spec);
}

bool TakesFlag(const SolverEntry& solver, const std::string& flag) {
  const std::vector<std::string> taken = FlagsOf(solver);
  return std::ranges::find(taken, flag) != taken.end();
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
