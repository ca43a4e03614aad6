#include "app/scene_flags.h"

#include "app/solver_flags.h"

namespace trilobe {

std::vector<std::string> SceneFlags() {
  return {"solver",
          "weighting",
          "lobes",
          "max_iterations",
          "max_seconds",
          "tolerance",
          "optimality_tolerance",
          "threads",
          "noise",
          "seed",
          "max_angle",
          "min_theta_d",
          "extrapolated",
          "cache",
          "nocache"};
}

std::vector<std::string> SceneModelFlags() {
  std::vector<std::string> flags = SceneFlags();
  for (const char* const flag : {"threads", "cache", "nocache"}) std::erase(flags, flag);
  for (const std::string& flag : ParticularSolverFlags()) flags.push_back(flag);
  return flags;
}

}  // namespace trilobe
