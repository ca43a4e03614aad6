#ifndef TRILOBE_FIT_CHOOSE_FORM_H_
#define TRILOBE_FIT_CHOOSE_FORM_H_

#include <functional>
#include <vector>

#include "fit/anisotropic_forms.h"
#include "trilobe/appearance/appearance.h"
#include "trilobe/base/stop_check.h"
#include "trilobe/brdf/node_brdf.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/objective/objective.h"
#include "trilobe/prune/model_choice.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// What a solver has made of one form.
struct SolvedForm {
  Objective data, solved;  // of what was measured; what the solver lowered
  FactorModel model;
  SolverSummary summary;
};

struct ChosenForm {
  SolvedForm form;
  std::vector<ModelCandidate> candidates;  // in the order in which they were tried
  int chosen = 0;                          // which of them
};

// Fits the forms after the first by `solve`, and takes the one that looks most like the measurement
// (NodeJudge, which goes by `first`); the first where none is ahead of it by half a decibel. Once
// `stop` is true the best of those that are finished.
ChosenForm ChooseForm(const std::vector<AnisotropicForm>& forms, SolvedForm first,
                      const NodeBrdf& measured, const AppearanceOptions& appearance,
                      const std::function<SolvedForm(const AnisotropicForm&)>& solve,
                      const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_CHOOSE_FORM_H_
