#ifndef TRILOBE_SOLVERS_MULTISTART_STIFF_STARTS_H_
#define TRILOBE_SOLVERS_MULTISTART_STIFF_STARTS_H_

#include <optional>
#include <span>
#include <vector>

#include "solvers/smooth/softening.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// GGX lobes to begin with: roughness from `narrow` to `wide`, tables as stiff as `stiffest`.
struct StiffStart {
  const char* name;
  double narrow, wide, stiffest;
};

// `wide`, `narrow` and `middle`. Starts that are alike agree for no other reason, so the most
// different ones come first.
std::span<const StiffStart> StiffStarts();

// Where tables that soften on the samples of `few` lead from one. What no sample reads is of
// `given`.
FactorModel SoftenStart(const StiffStart& start, const Objective& few, const FactorModel& given,
                        const StopCheck& stop, PhaseSeconds* phases);

// The samples of a grid with half the bins of theta_h and of theta_d, each the mean of up to four,
// of few phi_d; for a model whose tables have half the entries. A joint step takes a fifth of the
// time of one on thinned samples, and tables that are stiff hardly lose. None where the samples are
// so few that they are not thinned, or on no grid, or where an axis has an odd number of entries.
std::optional<Objective> CoarseObjective(const Objective& objective);

// A start, softened on coarse samples as long as tables are stiff.
struct CoarseStart {
  const char* name;
  FactorModel model;  // of half the entries
  double E = 0;       // on the coarse samples
};

// Where several starts lead on the samples of `coarse`: the lowest E first, and last what ends as
// another one does. The same bits for any number of threads. Times go to *phases, summed over what
// runs side by side; those that were not begun before `stop` are left out.
std::vector<CoarseStart> SoftenCoarseStarts(const Objective& coarse, int num_threads,
                                            const StopCheck& stop, PhaseSeconds* phases);

// Goes on from one on the samples of `few`. What no sample reads is of `given`.
FactorModel SoftenFurther(const CoarseStart& start, const Objective& few, const FactorModel& given,
                          const StopCheck& stop, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_MULTISTART_STIFF_STARTS_H_
