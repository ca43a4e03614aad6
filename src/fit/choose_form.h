#ifndef TRILOBE_FIT_CHOOSE_FORM_H_
#define TRILOBE_FIT_CHOOSE_FORM_H_

#include <functional>
#include <vector>

#include "fit/anisotropic_forms.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/prune/model_choice.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// What another form than the default has to be ahead by [dB]: judges know the material no better
// than that (docs/decisions/forms-of-anisotropic.md, docs/decisions/forms-of-scattered.md).
inline constexpr double kAhead = 0.5;

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
// to `judge` [dB], which is asked of canonical models; the first where none is ahead of it by half
// a decibel. Once `stop` is true the best of those that are finished.
ChosenForm ChooseForm(const std::vector<AnisotropicForm>& forms, SolvedForm first,
                      const std::function<double(const FactorModel&)>& judge,
                      const std::function<SolvedForm(const AnisotropicForm&)>& solve,
                      const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_CHOOSE_FORM_H_
