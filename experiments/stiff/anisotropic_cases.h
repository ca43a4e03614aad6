#ifndef TRILOBE_EXPERIMENTS_STIFF_ANISOTROPIC_CASES_H_
#define TRILOBE_EXPERIMENTS_STIFF_ANISOTROPIC_CASES_H_

#include <vector>

#include "experiments/stiff/cases.h"

namespace trilobe {

// Cases of models with D and G over azimuths, on few nodes.
std::vector<StiffCase> AnisotropicCases();

// A model or a measurement turned about the normal by so many of its nodes' steps in phi.
FactorModel Turned(const FactorModel& model, int nodes);
StiffProblem Turned(StiffProblem problem, int nodes);

// A case whose data are those of another one, turned.
struct Twin {
  const char* name;
  const char* original;
  int nodes;
};
std::vector<Twin> Twins();

}  // namespace trilobe

#endif  // TRILOBE_EXPERIMENTS_STIFF_ANISOTROPIC_CASES_H_
