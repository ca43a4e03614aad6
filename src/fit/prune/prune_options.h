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

  // Which parameters of the full model are stored already, of which more may be left out; null:
  // all. For isotropic models only.
  std::optional<TableLayout> layout = std::nullopt;

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
  bool adds = false;  // a lobe, as the budget asks for less error
  std::string why;
};

struct PrunedModel {
  FactorModel model;   // of full-size tables, in canonical form
  TableLayout layout;  // which of its parameters are stored
  std::vector<PruneDecision> decisions;
  double E = 0;            // Objective::Value of the model
  int num_parameters = 0;  // stored
};

}  // namespace trilobe

#endif  // TRILOBE_FIT_PRUNE_PRUNE_OPTIONS_H_
