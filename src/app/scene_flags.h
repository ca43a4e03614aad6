#ifndef TRILOBE_APP_SCENE_FLAGS_H_
#define TRILOBE_APP_SCENE_FLAGS_H_

#include <string>
#include <vector>

namespace trilobe {

// The flags of the commands that fit scenes; those that only some solvers read are not among them.
std::vector<std::string> SceneFlags();

// The flags on which the models depend.
std::vector<std::string> SceneModelFlags();

}  // namespace trilobe

#endif  // TRILOBE_APP_SCENE_FLAGS_H_
