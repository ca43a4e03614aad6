#ifndef TRILOBE_SOLVERS_STARTS_INITIAL_MODEL_H_
#define TRILOBE_SOLVERS_STARTS_INITIAL_MODEL_H_

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// A named, deterministic starting point.
struct InitialModel {
  std::string name;
  std::string description;
  // Returns a model with the objective's spec. Its parameters are finite, and > 0 in lobes with
  // s > 0. Only the random starts use `seed`.
  FactorModel (*make)(const Objective& objective, uint64_t seed) = nullptr;
};

// All starting points, the default one first.
const std::vector<InitialModel>& InitialModels();

// Throws Error for an unknown name; the message lists the known ones.
const InitialModel& FindInitialModel(std::string_view name);

// A starting point for continuation: GGX lobes with roughnesses evenly spaced in the logarithm from
// `narrow` to `wide`. Each reflects the same fraction of the mean measured reflectance.
FactorModel SpreadModel(const Objective& objective, double narrow, double wide);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_STARTS_INITIAL_MODEL_H_
