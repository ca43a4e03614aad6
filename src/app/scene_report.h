#ifndef TRILOBE_APP_SCENE_REPORT_H_
#define TRILOBE_APP_SCENE_REPORT_H_

#include <nlohmann/json_fwd.hpp>
#include <ostream>

#include "app/scene_result.h"

namespace trilobe {

// What each material of a scene needs and why, and what is left out.
void PrintPlan(const SceneRun& run, std::ostream& out);

// plan.json (docs/scene.md).
nlohmann::ordered_json PlanToJson(const SceneRun& run);

}  // namespace trilobe

#endif  // TRILOBE_APP_SCENE_REPORT_H_
