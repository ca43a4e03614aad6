#ifndef TRILOBE_FIT_SCENE_MATERIAL_FIT_H_
#define TRILOBE_FIT_SCENE_MATERIAL_FIT_H_

#include <optional>
#include <string>
#include <vector>

#include "fit/prune/prune.h"
#include "fit/scene/fit_cache.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/fit_options.h"
#include "trilobe/io/formats/measurement_format.h"
#include "trilobe/io/formats/model_file.h"
#include "trilobe/model/appearance/appearance.h"
#include "trilobe/model/objective/score.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// Settings of the full fits of a scene's materials.
struct SceneFitSettings {
  // Options of the fits and of reading measurements, but for SceneMaterial::options;
  // solver_options, num_threads and callbacks are replaced.
  FitOptions fit;
  SourceOptions source;
  SolverOptions options;  // stop is replaced
  std::string program;    // "trilobe 0.1.0", for model files
  std::string build;      // build of the program; fits of another build are not reused
  // For budgets of appearance and verdicts; num_threads is replaced.
  AppearanceOptions appearance;
  bool verdicts = false;
  FitCache cache;
  // Called after each iteration, from several threads. Return true to stop and keep nothing.
  StopCheck stop = {};
};

// Score of a fit on the samples that a scene uses.
struct SceneScore {
  double objective = 0;  // E
  double psnr_db = 0;
  // Values of SceneJudge, for a budget of appearance or a verdict.
  std::optional<double> mean_delta_e = std::nullopt, seen_psnr_db = std::nullopt;
};

// Relative rise of E, 0.01 for 1 %; 0 if E of the full fit is 0.
inline double RelativeRise(const SceneScore& full, const SceneScore& pruned) {
  return full.objective > 0 ? pruned.objective / full.objective - 1 : 0;
}

// A fit with nothing left out.
struct FullFit {
  ModelFile file;
  double seconds = 0;  // reading, preparing and fitting, when it was made
  bool from_cache = false;
};

// Memory of parameters [bytes].
inline int BytesOf(int parameters) { return parameters * static_cast<int>(sizeof(double)); }

// The fit of a material of a scene.
struct MaterialFit {
  std::string name;
  std::vector<std::string> data_notes;  // as in Measurement
  int valid_samples = 0;                // of the measurement
  int used_samples = 0;                 // of these, by the fit
  int full_parameters = 0;
  SceneScore full, pruned;
  // Visible difference of the pruned model in the scene (Words); empty without `verdicts`.
  std::string verdict;
  bool judged_by_reads = false;  // SceneJudge::Kind::kReads, not the sphere
  bool misses_budget = false;    // PrunedModel::misses_budget
  ModelFile file;                // the pruned model, with the fit information of the full one
  int num_parameters = 0;        // stored
  std::vector<PruneDecision> decisions;
  double fit_seconds = 0, prune_seconds = 0;  // when they were made
  bool fit_from_cache = false, prune_from_cache = false;
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_MATERIAL_FIT_H_
