#ifndef TRILOBE_APP_SCENE_RUN_H_
#define TRILOBE_APP_SCENE_RUN_H_

#include <gflags/gflags_declare.h>

#include <functional>
#include <string>
#include <vector>

#include "fit/scene/material_fit.h"
#include "fit/scene/scene_file.h"
#include "fit/scene/scene_fit.h"

DECLARE_bool(nocache);

namespace trilobe {

// The flags of the commands that fit scenes; those that only some solvers read are not among them.
std::vector<std::string> SceneFlags();

// The flags on which the models depend.
std::vector<std::string> SceneModelFlags();

// The materials of a scene, fitted.
struct SceneRun {
  Scene scene;
  std::vector<MaterialFit> fits = {};  // those that were finished, in the order of the scene
  struct Failure {
    std::string name, error;
  };
  std::vector<Failure> failures = {};
  int threads = 0;
  // From the first file read to the last model, all side by side. Where fits came from the cache,
  // that says nothing: then it is what the parts took when they were made, spread over the threads.
  double seconds = 0;
  int reused = 0;       // materials that took something from the cache
  int interrupted = 0;  // the signal that ended it; 0 for none
};

// What the flags of a scene ask for. Throws Error for a value that makes no sense.
SceneFitSettings SceneSettingsFromFlags();

// Fits the scene. With a terminal it shows how far it is; Ctrl-C keeps what is finished. `on_done`
// sees each material when it is finished, one at a time. A material that fails does not stop the
// others. An InterruptGuard must live.
SceneRun RunScene(Scene scene, const SceneFitSettings& settings,
                  const std::function<void(const MaterialFit&)>& on_done);

}  // namespace trilobe

#endif  // TRILOBE_APP_SCENE_RUN_H_
