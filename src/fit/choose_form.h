#ifndef TRILOBE_FIT_CHOOSE_FORM_H_
#define TRILOBE_FIT_CHOOSE_FORM_H_

#include <functional>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/finish/candidate.h"
#include "trilobe/fit/fit_options.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/measurement/node_brdf.h"
#include "trilobe/model/model_spec.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// Throws Error where the options give a start or nodes, which each of these forms has of its own.
void CheckMayChooseForms(const FitOptions& options);

// Forms of at most max_parameters parameters, first `by_default` or the nearest to it. Each has D
// and G on the finest nodes within the budget, so one more lobe or tables by channel mean fewer
// nodes. Nodes are not finer than the data resolve and, unless the budget exceeds the size of
// `by_default`, not finer than its own. Throws Error if no nodes are few enough.
std::vector<FormSpec> AnisotropicForms(const ModelSpec& by_default, const HemisphereGrid& data,
                                       int max_parameters);

// Lead that another form than the default needs [dB]; smaller leads are within the accuracy of the
// judges (docs/decisions/forms.md).
inline constexpr double kAhead = 0.5;

// The fit of one form.
struct SolvedForm {
  Objective data, solved;  // of the measurement; minimised by the solver
  FactorModel model;
  SolverSummary summary;
};

struct ChosenForm {
  SolvedForm form;
  std::vector<Candidate> candidates;  // in the order tried
  int chosen = 0;                     // index of the chosen one
};

// Fits the forms after the first by `solve` and returns the form with the highest score by `judge`
// [dB], which gets canonical models; the first form if none leads it by kAhead. If stopped, chooses
// among the finished ones.
ChosenForm ChooseForm(const std::vector<FormSpec>& forms, SolvedForm first, const Judge& judge,
                      const std::function<SolvedForm(const FormSpec&)>& solve,
                      const StopCheck& stop);

}  // namespace trilobe

#endif  // TRILOBE_FIT_CHOOSE_FORM_H_
