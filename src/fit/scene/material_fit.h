#ifndef TRILOBE_FIT_SCENE_MATERIAL_FIT_H_
#define TRILOBE_FIT_SCENE_MATERIAL_FIT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "fit/prune/prune.h"
#include "fit/scene/fit_cache.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/io/model_files/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// How the materials of a scene are fitted, before anything is left out.
struct SceneFitSettings {
  std::string solver;
  SolverOptions options;  // stop is replaced
  std::string init;
  std::string weighting;
  int lobes = 3;
  double noise = 0;  // of synth: sources
  uint64_t seed = 1;
  // What counts as measured, as in SourceOptions:
  double max_angle_deg = 90;
  double min_theta_d_deg = -1;
  bool extrapolated = false;
  std::string program;  // "trilobe 0.1.0", for model files
  std::string build;    // and which build of it: what another one has fitted is not reused
  // By which budgets of appearance are judged, and verdicts, if there are to be any; threads are
  // replaced.
  AppearanceOptions appearance;
  bool verdicts = false;
  FitCache cache;
  // Asked after each iteration, from several threads; true to stop and keep nothing.
  StopCheck stop = {};
};

// What a fit reaches on the samples that a scene uses.
struct SceneScore {
  double objective = 0;  // E
  double psnr_db = 0;
  // Of its sphere, as the scene sees it, where the budget is one of look or there is a verdict.
  std::optional<double> mean_delta_e = std::nullopt, sphere_psnr_db = std::nullopt;
};

// By how much of it E is higher, 0.01 for 1 %; 0 where there is nothing to be relative to.
inline double RelativeRise(const SceneScore& full, const SceneScore& pruned) {
  return full.objective > 0 ? pruned.objective / full.objective - 1 : 0;
}

// A fit with nothing left out.
struct FullFit {
  ModelFile file;
  double seconds = 0;  // reading, preparing and fitting, when it was made
  bool from_cache = false;
};

// What parameters take in memory [bytes].
inline int BytesOf(int parameters) { return parameters * static_cast<int>(sizeof(double)); }

// What a material needs.
struct MaterialFit {
  std::string name;
  std::vector<std::string> data_notes;  // as in Measurement
  int valid_samples = 0;                // of the measurement
  int used_samples = 0;                 // of these, by the fit
  int full_parameters = 0;
  SceneScore full, pruned;
  // What a person would see of the pruned model, as the scene sees it (Words); empty unless asked
  // for.
  std::string verdict;
  ModelFile file;          // the pruned model, and how the full one came about
  int num_parameters = 0;  // that it stores
  std::vector<PruneDecision> decisions;
  double fit_seconds = 0, prune_seconds = 0;  // when they were made
  bool fit_from_cache = false, prune_from_cache = false;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_MATERIAL_FIT_H_
