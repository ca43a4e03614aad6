#ifndef TRILOBE_FIT_CHOOSE_FORM_H_
#define TRILOBE_FIT_CHOOSE_FORM_H_

#include <functional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/prune/model_choice.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// A form that --model=auto tries.
struct AnisotropicForm {
  std::string name;  // "as fitted", "4 lobes", "D by channel"
  ModelSpec spec;
};

// Forms of at most so many parameters, `by_default` or what comes nearest to it first: each with D
// and G on the finest nodes that keep to the budget. What another lobe or tables by channel cost is
// saved on nodes. None are finer than those of `by_default` but where the budget is above its size,
// nor than what data at so many directions tell apart. Throws Error where no nodes are few enough.
std::vector<AnisotropicForm> AnisotropicForms(const ModelSpec& by_default,
                                              const HemisphereGrid& data, int max_parameters);

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
