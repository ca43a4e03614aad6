#ifndef TRILOBE_APP_SCENE_PLAN_H_
#define TRILOBE_APP_SCENE_PLAN_H_

#include <nlohmann/json_fwd.hpp>
#include <ostream>
#include <string>

#include "app/scene_run.h"

namespace trilobe {

// Prints what each material of a scene needs and why, and what is left out.
void PrintPlan(const SceneRun& run, std::ostream& out);

// plan.json (docs/scene.md).
nlohmann::ordered_json PlanToJson(const SceneRun& run);

// Runs `trilobe fit --scene=SCENE --out=DIR`: writes a model file per material, plan.json and
// plan.txt. Returns the exit status.
int RunSceneFit(const std::string& path);

}  // namespace trilobe

#endif  // TRILOBE_APP_SCENE_PLAN_H_
