#include "app/fit_settings.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "app/flags.h"
#include "app/inputs.h"
#include "app/model_flags.h"
#include "app/solver_flags.h"
#include "core/files/file.h"
#include "core/system/content_hash.h"
#include "trilobe/core/base/error.h"
#include "trilobe/model/load_model.h"
#include "trilobe/solvers/starts/initial_model.h"

DEFINE_string(
    init, "analytic",
    "one of the starting points above, or the path of a model file, whose spec the fit then "
    "takes");
DEFINE_int32(max_parameters, 822,
             "with --model=auto: most parameters that the model may store; if not given, for "
             "scattered samples, as many as their default form has");
DEFINE_double(robust, 0,
              "continue with a loss that is linear in errors above this, as the weighting scales "
              "them, by reweighting; 0 for none");
DEFINE_double(
    smoothness, trilobe::FitOptions().smoothness,
    "relative rise of E that is allowed at the end for the smoothest tables, if it is not "
    "seen: without holes, and without falls that D and G exchange; 0 for the least E");
DEFINE_bool(match_reflectance, true,
            "for a table: if a fit that has converged reflects more or less light than was "
            "measured, by more than 1 %, let E rise a little to correct that, as far as neither "
            "the sphere nor the mean log error gets worse");
DEFINE_bool(raw, false,
            "store the model that the solver found, to compare solvers, for example: entries at "
            "the edge of the data are not tied, reflected light is not matched, tables are not "
            "smoothed");
DEFINE_bool(held_out, false,
            "also fit without a fifth of the blocks of directions, drawn by --data_seed, and "
            "report E and Delta E at these, which shows how well unseen directions are predicted. "
            "Takes twice as long");
DECLARE_bool(spectral);
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

// The starting point is a file where --init is not a name but something like a path.
bool InitIsFile() {
  for (const InitialModel& init : InitialModels()) {
    if (init.name == FLAGS_init) return false;
  }
  if (IsMaterial(FLAGS_init)) return true;
  std::error_code ignored;
  return FLAGS_init.find('/') != std::string::npos || FLAGS_init.ends_with(".json") ||
         std::filesystem::exists(FLAGS_init, ignored);
}

FactorModel StartFromFile() {
  FactorModel model = ModelOfSource(FLAGS_init).model;
  if (ModelIsGiven()) {
    throw Error(FLAGS_init +
                " brings its own lobes and tables; leave out --model, --lobes, --stretch, "
                "--d_nodes, --f_bins, --g_nodes and --nodes");
  }
  return model;
}

// Flags on which a result does not depend, or only by the content of a file.
constexpr const char* kFlagsOfNoResult[] = {"threads", "out",     "scene", "shard",
                                            "cache",   "nocache", "probe", "verbose"};

}  // namespace

std::vector<std::string> FitFlags() {
  std::vector<std::string> flags =
      WithSourceFlags({"solver", "init", "weighting", "prior", "robust", "smoothness",
                       "match_reflectance", "raw", "max_parameters", "spectral", "held_out"});
  for (const std::string& flag : ModelFlags()) flags.push_back(flag);
  for (const std::string& flag : CommonSolverFlags()) flags.push_back(flag);
  flags.insert(flags.end(), {"out", "reconstruction", "convergence", "plots", "verbose", "probe",
                             "shard", "scene", "cache", "nocache"});
  return flags;
}

namespace {

// Flags by which other files are written, but the same model.
constexpr const char* kFlagsOfNoModel[] = {"spectral", "reconstruction", "convergence",
                                           "held_out", "plots",          "diagnose"};

// `without`: flags that do not count.
std::string KeyOfFlags(std::span<const char* const> without) {
  std::vector<std::string> flags = FitFlags();
  for (const std::string& flag : ParticularSolverFlags()) flags.push_back(flag);
  std::string key;
  for (const char* const flag : kFlagsOfNoResult) std::erase(flags, flag);
  for (const char* const flag : without) std::erase(flags, flag);
  for (const auto& [flag, value] : GivenFlags(flags)) key += flag + "=" + value + "\n";
  return key;
}

}  // namespace

FitSettings FitSettingsFromFlags() {
  FitSettings settings;
  FitOptions& fit = settings.fit;
  fit.weighting = FindWeighting(FLAGS_weighting);
  const SolverEntry& solver = SolverFromFlags();
  fit.solver = solver.name;
  fit.solver_options = SolverOptionsByFlags(solver);
  fit.init = FLAGS_init;
  const bool init_is_file = InitIsFile();
  if (!init_is_file) FindInitialModel(FLAGS_init);  // its error
  if (!(FLAGS_robust >= 0 && FLAGS_robust <= 1e6)) throw Error("--robust must be from 0 to 1e6");
  if (!(FLAGS_smoothness >= 0 && FLAGS_smoothness <= 1)) {
    throw Error("--smoothness must be from 0 to 1");
  }
  if (ChoosesModel() && !IsDefault("smoothness") && FLAGS_smoothness > 0) {
    throw Error(
        "--smoothness is for a form that is given: tables that --model=auto chooses are thinned");
  }
  if (FLAGS_raw) {
    for (const char* const flag : {"robust", "smoothness", "match_reflectance"}) {
      if (!IsDefault(flag)) {
        throw Error("--raw stores what the solver found; leave out --" + std::string(flag));
      }
    }
    if (ChoosesModel()) throw Error("--raw stores what the solver found; leave out --model=auto");
  }
  if (FLAGS_max_parameters < 1) throw Error("--max_parameters must be at least 1");
  if (!ChoosesModel() && !IsDefault("max_parameters")) {
    throw Error("--max_parameters goes with --model=auto");
  }
  fit.robust = FLAGS_robust;
  fit.smoothness = FLAGS_smoothness;
  fit.choose_form = ChoosesModel();
  if (!IsDefault("max_parameters")) fit.max_parameters = FLAGS_max_parameters;
  fit.match_reflectance = FLAGS_match_reflectance;
  fit.raw = FLAGS_raw;
  fit.bands = FLAGS_spectral;
  fit.appearance = AppearanceOptionsFromFlags();
  fit.form = FormFromFlags();
  fit.prior = PriorFromFlags();
  fit.seed = static_cast<uint64_t>(FLAGS_seed);
  fit.solver_options(ModelSpec());  // its errors
  settings.source = SourceOptionsFromFlags(/*has_starts=*/true);
  if (FLAGS_held_out) {
    fit.held_out = settings.source.seed;
    settings.source.seed_is_for_data = false;
  }
  settings.convergence = FLAGS_convergence;
  settings.reconstruction = FLAGS_reconstruction;
  settings.plots = settings.view = FLAGS_plots && !IsDefault("plots");
  settings.key = KeyOfFlags({});
  settings.model_key = KeyOfFlags(kFlagsOfNoModel);
  if (!FLAGS_probe.empty()) settings.inputs.push_back(FLAGS_probe);
  if (init_is_file) {
    fit.start_model = StartFromFile();
    if (!IsMaterial(FLAGS_init)) settings.inputs.push_back(FLAGS_init);
  }
  for (const std::string& input : settings.inputs) {
    const std::string content = ContentHash(ReadFile(input)) + "\n";
    settings.key += content;
    settings.model_key += content;
  }
  return settings;
}

}  // namespace trilobe
