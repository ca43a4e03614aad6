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

// Flags of commands that fit scenes, without those that only some solvers read.
std::vector<std::string> SceneFlags();

// Flags that affect the models.
std::vector<std::string> SceneModelFlags();

// The materials of a scene, fitted.
struct SceneRun {
  Scene scene;
  std::vector<MaterialFit> fits = {};  // finished fits, in the order of the scene
  struct Failure {
    std::string name, error;
  };
  std::vector<Failure> failures = {};
  int threads = 0;
  // Wall time from the first file read to the last model. If fits came from the cache: the sum of
  // the times when they were made, divided by the threads.
  double seconds = 0;
  int reused = 0;       // materials with a cached part
  int interrupted = 0;  // the signal that ended the run; 0: none
};

// Settings by the flags of a scene. Throws Error for bad values.
SceneFitSettings SceneSettingsFromFlags();

// Fits the scene and shows progress on a terminal. Ctrl-C keeps the finished materials. `on_done`
// is called with each finished material, one call at a time. A failed material does not stop the
// others. An InterruptGuard must exist.
SceneRun RunScene(Scene scene, const SceneFitSettings& settings,
                  const std::function<void(const MaterialFit&)>& on_done);

}  // namespace trilobe

#endif  // TRILOBE_APP_SCENE_RUN_H_
