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

// Fits a material as the scene limits it, and leaves out what its budget allows. Nothing if it was
// stopped. The same bits for any number of threads, unless seconds are the budget or a limit.
// Throws Error.
std::optional<MaterialFit> FitMaterial(const SceneMaterial& material,
                                       const SceneFitSettings& settings, int num_threads);

// What became of a material: a fit, or why there is none; neither if it was stopped.
struct MaterialResult {
  std::optional<MaterialFit> fit;
  std::string error;
};

// All materials side by side, a thread each, to which come the threads that have no material left.
// `on_done` sees each when it is finished, one at a time; an Error that it throws counts as the
// material's. One that fails does not stop the others.
std::vector<MaterialResult> FitScene(const Scene& scene, const SceneFitSettings& settings,
                                     int num_threads,
                                     const std::function<void(const MaterialFit&)>& on_done);

// What one would do without a scene: the material as a whole, in all directions and in RGB, on all
// threads, with the diagnosis that `trilobe fit` makes. Timed for itself, so a fit of FitScene is
// not reused. Nothing if it was stopped.
std::optional<FullFit> FitWhole(const SceneMaterial& material, const SceneFitSettings& settings,
                                int num_threads);

// How well any models do on the samples that the scene uses of the material, which is read once.
std::vector<SceneScore> ScoreOnScene(std::span<const FactorModel> models,
                                     const SceneMaterial& material,
                                     const SceneFitSettings& settings, int num_threads);

}  // namespace trilobe

#endif  // TRILOBE_FIT_SCENE_SCENE_FIT_H_
