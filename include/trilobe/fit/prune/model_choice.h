#ifndef TRILOBE_FIT_PRUNE_MODEL_CHOICE_H_
#define TRILOBE_FIT_PRUNE_MODEL_CHOICE_H_

#include <functional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/model/objective/weighting.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

struct ModelChoiceOptions {
  int max_parameters = 822;  // stored: values, without the places of nodes

  // How good a model is to the eye [dB]; the highest wins, the first of equals.
  std::function<double(const FactorModel&)> judge;

  // How good one is in all directions, where some were not measured. One that is more than
  // 3 dB below the fitted model there, and more than half of what it gains where data are, runs
  // astray where they end, and is not taken.
  std::function<double(const FactorModel&)> judge_beyond = nullptr;

  // Asked after each step; true to stop with the best so far that keeps to the budget.
  StopCheck stop = {};
};

// One form that was tried.
struct ModelCandidate {
  std::string name;           // "as fitted", "stretched", "stretched, thinned", ...
  int num_parameters = 0;     // stored
  double E = 0;               // Objective::Value; of a form that is not stored, about that
  double score = 0;           // by the judge; -infinity where that says NaN
  bool fails_beyond = false;  // beyond the data, and not chosen for that
  double seconds = 0;         // that it took to make, from the one that it came from
};

struct ChosenModel {
  FactorModel model;    // of full-size tables, in canonical form but for the order of its lobes
  TableLayout layout;   // which of its parameters are stored
  Weighting weighting;  // by which the form was fitted; that of the objective or by channel
  std::vector<ModelCandidate> candidates;  // in the order in which they were tried
  int chosen = -1;                         // which of them; there is always one
};

// The form that looks best within a budget of parameters (docs/model-choice.md): the fitted model
// itself, thinned if it has more parameters; or one whose lobes are stretched, that is weighed by
// channel, shares neither F nor D, or has a lobe more, fitted from there by some joint
// steps and thinned to the budget. Where one parameter a table is too much, what Prune makes of the
// fitted model, with fewer lobes or colours. `fitted` is a fit of the objective, in canonical form,
// and has its spec. The same bits for any number of threads, as long as `stop` stays false. Throws
// Error for a budget below 1.
ChosenModel ChooseModel(const Objective& objective, const FactorModel& fitted,
                        const ModelChoiceOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_MODEL_CHOICE_H_
