#ifndef TRILOBE_SOLVERS_STARTS_STIFF_STARTS_H_
#define TRILOBE_SOLVERS_STARTS_STIFF_STARTS_H_

#include <optional>
#include <span>
#include <vector>

#include "solvers/joint/softening.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// A start of GGX lobes with roughness from `narrow` to `wide` and stiffness `stiffest` (lambda).
struct StiffStart {
  const char* name;
  double narrow, wide, stiffest;
};

// `wide`, `narrow` and `middle`: the most different ones first, since similar starts agree without
// meaning.
std::span<const StiffStart> StiffStarts();

// Softens a start on the samples of `few` (Soften). Unobserved entries are those of `given`.
FactorModel SoftenStart(const StiffStart& start, const Objective& few, const FactorModel& given,
                        const StopCheck& stop, PhaseSeconds* phases);

// An objective on half the bins of theta_h and theta_d and few phi_d, each bin the mean of up to
// four, for tables of half the entries. A joint step takes a fifth of the time of one on thinned
// samples, and stiff tables lose little. Nothing if the samples are too few to be thinned or on no
// grid, or an axis has an odd number of entries.
std::optional<Objective> CoarseObjective(const Objective& objective);

// A start softened on coarse samples while tables are stiff.
struct CoarseStart {
  const char* name;
  FactorModel model;  // with half the entries
  double E = 0;       // on the coarse samples
};

// Softens several starts on the samples of `coarse`. Sorted by E, with duplicates of others last.
// The same bits for any number of threads. Adds times, summed over parallel starts, to *phases.
// Starts not begun before `stop` are omitted.
std::vector<CoarseStart> SoftenCoarseStarts(const Objective& coarse, int num_threads,
                                            const StopCheck& stop, PhaseSeconds* phases);

// Continues a coarse start on the samples of `few`. Unobserved entries are those of `given`.
FactorModel SoftenFurther(const CoarseStart& start, const Objective& few, const FactorModel& given,
                          const StopCheck& stop, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_STARTS_STIFF_STARTS_H_
