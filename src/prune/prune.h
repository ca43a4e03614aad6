#ifndef TRILOBE_PRUNE_PRUNE_H_
#define TRILOBE_PRUNE_PRUNE_H_

#include <limits>
#include <string>
#include <vector>

#include "trilobe/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/table_layout.h"
#include "trilobe/objective/objective.h"

namespace trilobe {

// What may be left out of a model, and what that may cost.
struct PruneOptions {
  // By which fraction E may rise above that of the full model. Below 0 it must fall, for which
  // lobes may be added, up to max_lobes.
  double max_relative_rise = 0.01;
  // By how much the PSNR of `trilobe score` may fall [dB]. Below 0 it must rise.
  double max_psnr_drop_db = std::numeric_limits<double>::infinity();
  // How far off a model looks, in any measure that is 0 where it is right and grows about as the
  // root of E; and how far off it may look. In the place of PSNR. Null: it does not count.
  std::function<double(const FactorModel&)> error = nullptr;
  double max_error = std::numeric_limits<double>::infinity();
  // A budget in stored parameters instead: what is wanted is the lowest E that so many reach, and
  // the limits above do not count. A byte budget is 8 times as many.
  int max_parameters = std::numeric_limits<int>::max();

  // What may be left out; what must not stays as it is.
  bool lobes = true;
  bool colour = true;     // tables, then d and s, shared by the channels
  bool shadowing = true;  // G: shared by the lobes, constant, or thinned
  bool tables = true;     // entries of D and F: dropped where no data are, and thinned
  // False: lobes and channels share no more than they do, whatever `colour` and `shadowing` allow,
  // and G becomes constant only by thinning; saves the time to look. Anisotropic models: of no
  // effect.
  bool sharing = true;
  // More lobes than the full model's, where the budget asks for a lower E. 0: none.
  int max_lobes = 0;

  // Asked after each step; true to stop, after which what comes back is of no use.
  StopCheck stop = {};
};

// One thing that was tried.
struct PruneDecision {
  std::string what;  // "2 lobes instead of 3"
  int parameters_before = 0, parameters_after = 0;
  double E_before = 0, E_after = 0;
  bool taken = false;
  std::string why;
};

struct PrunedModel {
  FactorModel model;   // of full-size tables, in canonical form
  TableLayout layout;  // which of its parameters are stored
  std::vector<PruneDecision> decisions;
  double E = 0;            // Objective::Value of the model
  int num_parameters = 0;  // stored
};

// The smallest model found that keeps within the budget (docs/pruning.md). `full` is a fit of the
// objective and has its spec. What is returned never exceeds the budget, up to rounding (1e-12 of
// E, and E of a fit that is exact but for rounding); if the full model does, and more lobes do not
// help, it is the one that comes closest, and the last decision says so. With a budget of 0 nothing
// moves, and only what is free is left out; where that is nothing, `full` comes back to the bit.
//
// Costs less than a fit by the solver `auto`; the same bits for any number of threads.
// Where a budget is relative to an E that is practically 0, so that it allows next to nothing, the
// first decision says so. Throws Error for a budget that is no number, or less than one stored
// parameter.
PrunedModel Prune(const Objective& objective, const FactorModel& full, const PruneOptions& options);

// The same for a fit that had a guide: models are fitted to `guided`, the samples of `measured` and
// those of the guide, and held against the budget by `measured` alone, as are all E of the result.
PrunedModel Prune(const Objective& measured, const Objective& guided, const FactorModel& full,
                  const PruneOptions& options);

}  // namespace trilobe

#endif  // TRILOBE_PRUNE_PRUNE_H_
