#include "app/fit_flags.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "app/flags.h"
#include "app/inputs.h"
#include "app/solver_flags.h"
#include "trilobe/core/base/error.h"
#include "trilobe/fit/form.h"
#include "trilobe/model/load_model.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe {
namespace {

template <typename Condition>
std::vector<std::string> FlagsWhere(const Condition& holds) {
  std::vector<std::string> flags;
  for (const FitOption& option : AllFitOptions()) {
    if (holds(option)) flags.push_back(option.name);
  }
  return flags;
}

// The starting point is a file where --init is not a name but something like a path.
bool IsFile(const std::string& init) {
  for (const InitialModel& model : InitialModels()) {
    if (model.name == init) return false;
  }
  std::error_code ignored;
  return IsMaterial(init) || init.find('/') != std::string::npos || init.ends_with(".json") ||
         std::filesystem::exists(init, ignored);
}

FactorModel StartFromFile(const std::string& init) {
  FactorModel model = ModelOfSource(init).model;
  if (ModelIsGiven()) {
    throw Error(ErrorKind::kConflict,
                init +
                    " brings its own lobes and tables; leave out --model, --lobes, --stretch, "
                    "--d_nodes, --f_bins, --g_nodes and --nodes")
        .About("init", init);
  }
  return model;
}

}  // namespace

void DefineFitFlags() {
  for (const FitOption& option : AllFitOptions()) {
    DefineFlag(option.name, option.help, option.default_value);
  }
}

std::vector<std::string> FitOptionFlags() {
  return FlagsWhere([](const FitOption&) { return true; });
}

std::vector<std::string> ModelFlags() {
  return FlagsWhere([](const FitOption& option) { return option.of_form; });
}

std::vector<std::string> SceneFitOptionFlags() {
  return FlagsWhere([](const FitOption& option) { return option.of_scenes; });
}

bool ModelIsGiven() {
  return std::ranges::any_of(ModelFlags(),
                             [](const std::string& flag) { return !IsDefault(flag); });
}

bool ChoosesModel() { return FindForm(TextFlag("model")).chosen; }

FitOptions FitOptionsFromFlags() {
  FitOptions options;
  options.seed = static_cast<uint64_t>(FLAGS_seed);
  for (const FitOption& option : AllFitOptions()) {
    if (IsDefault(option.name)) continue;
    option.set(FlagText(option.name), &options);
    if (IsOn("raw") && option.follows_solver) FailWithRaw(option);
  }
  options.solver_options = SolverOptionsByFlags(SolverFromFlags());
  if (IsFile(options.init)) options.start_model = StartFromFile(options.init);
  CheckFitOptions(options);
  options.solver_options(ModelSpec());  // its errors
  return options;
}

}  // namespace trilobe
