#ifndef TRILOBE_SOLVERS_START_INITIAL_MODEL_H_
#define TRILOBE_SOLVERS_START_INITIAL_MODEL_H_

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
  // A model with the objective's spec, finite and > 0 where a lobe reflects anything. `seed`
  // matters to the random starts only.
  FactorModel (*make)(const Objective& objective, uint64_t seed) = nullptr;
};

// All of them, the default one first.
const std::vector<InitialModel>& InitialModels();

// Throws Error that lists the known names.
const InitialModel& FindInitialModel(std::string_view name);

// A starting point for continuation: GGX, a lobe, with roughnesses spread evenly in the logarithm
// from `narrow` to `wide`, all of which reflect the same part of the mean of what was measured.
FactorModel SpreadModel(const Objective& objective, double narrow, double wide);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_START_INITIAL_MODEL_H_
