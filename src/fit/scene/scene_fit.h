#ifndef TRILOBE_FIT_SCENE_SCENE_FIT_H_
#define TRILOBE_FIT_SCENE_SCENE_FIT_H_

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "fit/scene/material_fit.h"
#include "fit/scene/scene_file.h"
#include "trilobe/model/factor_model.h"

namespace trilobe {

// Fits a material on the directions and channels of the scene and prunes it to its budget. Returns
// nothing if stopped. The same bits for any number of threads, unless seconds are the budget or a
// limit. Throws Error.
std::optional<MaterialFit> FitMaterial(const SceneMaterial& material,
                                       const SceneFitSettings& settings, int num_threads);

// Outcome for a material: a fit or an error; neither if stopped.
struct MaterialResult {
  std::optional<MaterialFit> fit;
  std::string error;
};

// Fits all materials in parallel, one thread each; idle threads join those that remain. `on_done`
// is called with each finished material, one call at a time; an Error that it throws counts as the
// material's. A failed material does not stop the others.
std::vector<MaterialResult> FitScene(const Scene& scene, const SceneFitSettings& settings,
                                     int num_threads,
                                     const std::function<void(const MaterialFit&)>& on_done);

// Fits a material as without a scene: all directions, RGB, all threads, with the diagnosis of
// `trilobe fit`. Does not reuse a fit of FitScene, so that its time is its own. Returns nothing if
// stopped.
std::optional<FullFit> FitWhole(const SceneMaterial& material, const SceneFitSettings& settings,
                                int num_threads);

// Scores of models on the samples of the material that the scene uses. Reads the material once.
std::vector<SceneScore> ScoreOnScene(std::span<const FactorModel> models,
                                     const SceneMaterial& material,
                                     const SceneFitSettings& settings, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_FIT_H_
