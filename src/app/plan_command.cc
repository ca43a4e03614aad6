#include <iostream>
#include <nlohmann/json.hpp>

#include "app/command.h"
#include "app/flags.h"
#include "app/interrupt.h"
#include "app/scene_plan.h"
#include "app/scene_run.h"
#include "app/solver_flags.h"
#include "fit/reports/print.h"

namespace trilobe {
namespace {

int RunPlan(std::span<const std::string> arguments) {
  const SceneFitSettings settings = SceneSettingsFromFlags();
  const InterruptGuard guard;
  const SceneRun run = RunScene(ReadScene(arguments[0]), settings, [](const MaterialFit&) {});
  if (FLAGS_json) {
    PrintJson(PlanToJson(run));
  } else {
    PrintPlan(run, std::cout);
  }
  if (run.interrupted != 0) return 128 + run.interrupted;
  return run.failures.empty() ? 0 : kSomeFailed;
}

}  // namespace

Command PlanCommand() {
  std::vector<std::string> flags = SceneFlags();
  flags.insert(flags.begin(), "json");
  return {.name = "plan",
          .summary = "say what the materials of a scene need, and what can be left out",
          .arguments = "SCENE",
          .min_arguments = 1,
          .max_arguments = 1,
          .details =
              "Fits each material of the scene file (docs/scene.md) to the directions and channels "
              "that the scene\nuses, tries what can be left out within the budget, and prints it: "
              "lobes, colour, shadowing, entries\nof tables, samples; each with what it saves and "
              "costs. Nothing is written but the cache, out of which\n`trilobe fit --scene=SCENE` "
              "then takes the models. With --json, one JSON object, as plan.json.",
          .flags = flags,
          .particular_flags = ParticularSolverFlags(),
          .run = RunPlan};
}

}  // namespace trilobe
