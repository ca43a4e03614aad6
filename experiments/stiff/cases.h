#ifndef TRILOBE_EXPERIMENTS_STIFF_CASES_H_
#define TRILOBE_EXPERIMENTS_STIFF_CASES_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/brdf_samples.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/objective.h"

namespace trilobe {

// A small problem that is hard in one way.
struct StiffProblem {
  BrdfSamples samples;
  ModelSpec spec;
  std::string weighting = "compressive";
  std::optional<FactorModel> truth;  // model of the values before they were changed
  std::optional<FactorModel> start;  // initial model; else the library's default start
};

// A named one; `make` gives the same bits every time.
struct StiffCase {
  std::string name;
  std::string description;  // one line: what is hard
  StiffProblem (*make)() = nullptr;
};

// All of them.
const std::vector<StiffCase>& StiffCases();

// Throws Error that lists the known names.
const StiffCase& FindStiffCase(std::string_view name);

// The problem as the library sees it, on one thread; and the start.
Objective MakeObjective(const StiffProblem& problem);
FactorModel StartOf(const StiffProblem& problem, const Objective& objective);

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_STIFF_CASES_H_
