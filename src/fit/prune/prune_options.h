#ifndef TRILOBE_FIT_PRUNE_PRUNE_OPTIONS_H_
#define TRILOBE_FIT_PRUNE_PRUNE_OPTIONS_H_

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/table_layout.h"

namespace trilobe {

// Budget of Prune and permitted reductions.
struct PruneOptions {
  // Largest relative rise of E over the full model. Below 0, E must fall; lobes may then be added,
  // up to max_lobes.
  double max_relative_rise = 0.01;
  // Largest fall of the PSNR of `trilobe score` [dB]. Below 0 it must rise.
  double max_psnr_drop_db = std::numeric_limits<double>::infinity();
  // A visible error and its limit, which replace PSNR: any measure that is 0 for a perfect model
  // and grows about as the square root of E. Null: no limit.
  std::function<double(const FactorModel&)> error = nullptr;
  double max_error = std::numeric_limits<double>::infinity();
  // Budget in stored parameters, which replaces the limits above: the result has the lowest E found
  // for so many. A byte budget is 8 times as large.
  int max_parameters = std::numeric_limits<int>::max();

  // Stored parameters of the full model; null: all. For isotropic models only.
  std::optional<TableLayout> layout = std::nullopt;

  // Permitted reductions.
  bool lobes = true;
  bool colour = true;     // channels share tables, then d and s
  bool shadowing = true;  // G: shared by the lobes, constant, or thinned
  bool tables = true;     // D and F: unobserved entries dropped, others thinned
  // False: no further sharing by lobes and channels, whatever `colour` and `shadowing` allow; G
  // becomes constant only by thinning. Saves time. No effect on anisotropic models.
  bool sharing = true;
  // Largest number of lobes if the budget requires a lower E. 0: adds none.
  int max_lobes = 0;

  // Called after each step. Return true to stop; the result is then meaningless.
  StopCheck stop = {};
};

// A reduction that was tried.
struct PruneDecision {
  std::string what;  // "2 lobes instead of 3"
  int parameters_before = 0, parameters_after = 0;
  double E_before = 0, E_after = 0;
  bool taken = false;
  bool adds = false;  // adds a lobe to lower E
  std::string why;
};

struct PrunedModel {
  FactorModel model;   // with full-size tables, in canonical form
  TableLayout layout;  // which parameters are stored
  std::vector<PruneDecision> decisions;
  double E = 0;                // Objective::Value of the model
  int num_parameters = 0;      // stored
  bool misses_budget = false;  // no form was found that meets it
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNE_OPTIONS_H_
