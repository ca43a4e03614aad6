#include "app/fit_settings.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "app/fit_flags.h"
#include "app/flags.h"
#include "app/solver_flags.h"
#include "core/files/file.h"
#include "core/system/content_hash.h"
#include "trilobe/model/load_model.h"

DEFINE_bool(reconstruction, false,
            "also write DIR/reconstruction.binary, the fit in MERL layout, or, for an anisotropic "
            "model, DIR/reconstruction.bin, in UTIA's");
DEFINE_bool(convergence, false,
            "also write DIR/convergence.csv: errors of the intermediate models, scored after the "
            "fit");
DEFINE_bool(plots, true,
            "write the page of `trilobe view` and the pictures of `trilobe plot` into DIR; "
            "without --out that is out/NAME. For several SOURCEs, only if asked for");

namespace trilobe {
namespace {

// Flags on which a result does not depend, or only by the content of a file.
constexpr const char* kFlagsOfNoResult[] = {"threads", "out",     "scene", "shard",
                                            "cache",   "nocache", "probe", "verbose"};

}  // namespace

std::vector<std::string> FitFlags() {
  std::vector<std::string> flags = WithSourceFlags(FitOptionFlags());
  for (const std::string& flag : CommonSolverFlags()) flags.push_back(flag);
  flags.insert(flags.end(), {"out", "reconstruction", "convergence", "plots", "verbose", "probe",
                             "shard", "scene", "cache", "nocache"});
  return flags;
}

namespace {

// Without `others`.
std::string KeyOfFlags(std::span<const std::string> others) {
  std::vector<std::string> flags = FitFlags();
  for (const std::string& flag : ParticularSolverFlags()) flags.push_back(flag);
  std::string key;
  for (const char* const flag : kFlagsOfNoResult) std::erase(flags, flag);
  for (const std::string& flag : others) std::erase(flags, flag);
  for (const auto& [flag, value] : GivenFlags(flags)) key += flag + "=" + value + "\n";
  return key;
}

// By the flags that change a model; the others write further files.
std::string KeyOfModel() {
  std::vector<std::string> others = {"reconstruction", "convergence", "plots", "diagnose"};
  for (const FitOption& option : AllFitOptions()) {
    if (!option.changes_model) others.push_back(option.name);
  }
  return KeyOfFlags(others);
}

}  // namespace

FitSettings FitSettingsFromFlags() {
  FitSettings settings;
  FitOptions& fit = settings.fit;
  fit = FitOptionsFromFlags();
  fit.appearance = AppearanceOptionsFromFlags();
  settings.source = SourceOptionsFromFlags(/*has_starts=*/true);
  if (fit.held_out) {
    fit.held_out = settings.source.seed;
    settings.source.seed_is_for_data = false;
  }
  settings.convergence = FLAGS_convergence;
  settings.reconstruction = FLAGS_reconstruction;
  settings.plots = settings.view = FLAGS_plots && !IsDefault("plots");
  settings.key = KeyOfFlags({});
  settings.model_key = KeyOfModel();
  if (!FLAGS_probe.empty()) settings.inputs.push_back(FLAGS_probe);
  if (fit.start_model && !IsMaterial(fit.init)) settings.inputs.push_back(fit.init);
  for (const std::string& input : settings.inputs) {
    const std::string content = ContentHash(ReadFile(input)) + "\n";
    settings.key += content;
    settings.model_key += content;
  }
  return settings;
}

}  // namespace trilobe
