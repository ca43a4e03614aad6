#ifndef TRILOBE_APP_SCENE_RESULT_H_
#define TRILOBE_APP_SCENE_RESULT_H_

#include <string>
#include <vector>

#include "fit/scene/material_fit.h"
#include "fit/scene/scene_file.h"

namespace trilobe {

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

}  // namespace trilobe

#endif  // TRILOBE_APP_SCENE_RESULT_H_
