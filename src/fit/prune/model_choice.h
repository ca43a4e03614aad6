#ifndef TRILOBE_FIT_PRUNE_MODEL_CHOICE_H_
#define TRILOBE_FIT_PRUNE_MODEL_CHOICE_H_

#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/fit/finish/candidate.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

struct ModelChoiceOptions {
  int max_parameters = 822;  // stored values, not counting positions of nodes
  Judge judge;               // the first of equals wins

  // Score in all directions [dB], if some were not measured. A form is rejected if it loses more
  // than 3 dB here and more than half of what it gains by `judge`, both against the fitted model.
  Judge judge_beyond = nullptr;

  // Called after each step. Return true to stop with the best form so far within the budget.
  StopCheck stop = {};
};

struct ChosenModel {
  FactorModel model;    // with full-size tables, in canonical form except for the order of lobes
  TableLayout layout;   // which parameters are stored
  Weighting weighting;  // of the fit of this form: the objective's, or by channel
  std::vector<Candidate> candidates;  // in the order tried
  int chosen = -1;                    // index of the chosen candidate; always set
};

// Chooses the form with the highest score within a budget of parameters (docs/forms.md).
// Candidates: the fitted model, thinned if it is too large; and forms with stretched lobes, weights
// by channel, unshared F or D, or one more lobe, each fitted from it by joint steps and thinned to
// the budget. If one parameter per table exceeds the budget, Prune reduces lobes or colours.
// `fitted` is a fit of the objective, with its spec and in canonical form. Unless stopped, gives
// the same bits for any number of threads. Throws Error for a budget below 1.
ChosenModel ChooseModel(const Objective& objective, const FactorModel& fitted,
                        const ModelChoiceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_MODEL_CHOICE_H_
