#ifndef TRILOBE_SOLVERS_MULTISTART_SMOOTH_STARTS_H_
#define TRILOBE_SOLVERS_MULTISTART_SMOOTH_STARTS_H_

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "solvers/smooth/softening.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// GGX lobes to begin with: roughness from `narrow` to `wide`, tables as stiff as `stiffest`.
struct SmoothStart {
  const char* name;
  double narrow, wide, stiffest;
};

// The widest, which has the longest way, begins stiffer.
inline constexpr SmoothStart kWideStart{"wide", 0.2, 0.6, 10 * kStiffTables};
inline constexpr SmoothStart kNarrowStart{"narrow", 0.02, 0.2, kStiffTables};

// `wide`, `narrow` and `middle`. Starts that are alike agree for no other reason, so the most
// different ones come first.
std::span<const SmoothStart> SmoothStarts();

// Where continuation on the samples of `few` leads from one. What no sample reads is of `given`.
FactorModel SoftenFrom(const SmoothStart& start, const Objective& few, const FactorModel& given,
                       const StopCheck& stop, PhaseSeconds* phases);

// Where continuation on few of the samples has led from several starts, and what all samples say.
struct SoftenedStart {
  std::string name;
  FactorModel model;
  double E = 0;  // on all samples
};

// Two at a time, from wide and narrow lobes; and if E is not the same there, from lobes between,
// and from the given model. Best first. Times go to *phases, summed over what runs side by side.
// The same bits for any number of threads. `on_pair` sees the best after each two.
std::vector<SoftenedStart> SoftenStarts(const Objective& objective, const FactorModel& given,
                                        const StopCheck& stop, PhaseSeconds* phases,
                                        const std::function<void(const SoftenedStart&)>& on_pair);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_MULTISTART_SMOOTH_STARTS_H_
