#include "solvers/multistart/smooth_starts.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "lobes/gauge.h"
#include "solvers/multistart/start_elimination.h"
#include "solvers/smooth/softening.h"
#include "trilobe/start/initial_model.h"
#include "trilobe/system/parallel.h"

namespace trilobe {
namespace {

// Starts that are alike agree for no other reason, so the most different ones come first; and the
// widest, which has the longest way, begins stiffer.
struct Spread {
  const char* name;
  double narrow, wide, stiffest;
};
constexpr Spread kSpreads[] = {{"wide", 0.2, 0.6, 10 * kStiffTables},
                               {"narrow", 0.02, 0.2, kStiffTables},
                               {"middle", 0.1, 0.6, kStiffTables}};
constexpr int kNumSpreads = std::size(kSpreads);

std::optional<SoftenedStart> SoftenStart(int number, const Objective& few, const FactorModel& given,
                                         const StopCheck& stop, PhaseSeconds* phases) {
  if (stop()) return std::nullopt;
  if (number == kNumSpreads) {
    return SoftenedStart{.name = "given", .model = Soften(few, given, kStiffTables, stop, phases)};
  }
  const auto& [name, narrow, wide, stiffest] = kSpreads[number];
  FactorModel model = SpreadModel(few, narrow, wide);
  CopyUnobservedParameters(few.coverage(), given, &model);
  return SoftenedStart{.name = name, .model = Soften(few, model, stiffest, stop, phases)};
}

}  // namespace

std::vector<SoftenedStart> SoftenStarts(const Objective& objective, const FactorModel& given,
                                        const StopCheck& stop, PhaseSeconds* phases,
                                        const std::function<void(const SoftenedStart&)>& on_pair) {
  constexpr int kPair = 2;
  const int stride = StartElimination::StrideFor(objective, StartElimination::kThinned);
  const Objective few(Thinned(objective.samples(), stride), objective.spec(), objective.weighting(),
                      /*num_threads=*/1);
  std::vector<SoftenedStart> starts;
  for (int first = 0; first <= kNumSpreads; first += kPair) {
    std::optional<SoftenedStart> pair[kPair];
    PhaseSeconds phases_of[kPair];
    ParallelJobs(kPair, objective.num_threads(),
                 [&](int k) { pair[k] = SoftenStart(first + k, few, given, stop, &phases_of[k]); });
    for (int k = 0; k < kPair; ++k) {
      *phases += phases_of[k];
      if (!pair[k]) continue;
      pair[k]->E = objective.Value(pair[k]->model);
      starts.push_back(*std::move(pair[k]));
    }
    if (starts.empty()) break;
    std::ranges::stable_sort(starts, {}, &SoftenedStart::E);
    on_pair(starts.front());
    if (stop() || CountAgreeing(starts) >= kPair) break;
  }
  return starts;
}

int CountAgreeing(const std::vector<SoftenedStart>& starts) {
  constexpr double kSameE = 0.005;
  return static_cast<int>(std::ranges::count_if(starts, [&](const SoftenedStart& start) {
    return start.E <= (1 + kSameE) * starts.front().E;
  }));
}

}  // namespace trilobe
