#ifndef TRILOBE_APP_SCENE_RUN_H_
#define TRILOBE_APP_SCENE_RUN_H_

#include <functional>
#include <string>
#include <vector>

#include "app/scene_result.h"
#include "fit/scene/scene_fit.h"

namespace trilobe {

// What the flags of a scene ask for. Throws Error for a value that makes no sense.
SceneFitSettings SceneSettingsFromFlags();

// Fits the scene. With a terminal it shows how far it is; Ctrl-C keeps what is finished. `on_done`
// sees each material when it is finished, one at a time. A material that fails does not stop the
// others. An InterruptGuard must live.
SceneRun RunScene(Scene scene, const SceneFitSettings& settings,
                  const std::function<void(const MaterialFit&)>& on_done);

// `trilobe fit --scene=SCENE --out=DIR`: a model file a material, plan.json and plan.txt. Returns
// the exit status.
int RunSceneFit(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_APP_SCENE_RUN_H_
