#include "solvers/multistart/smooth_starts.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "model/lobes/gauge.h"
#include "solvers/multistart/agreement.h"
#include "solvers/multistart/start_elimination.h"
#include "solvers/smooth/softening.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/solvers/start/initial_model.h"

namespace trilobe {
namespace {

constexpr SmoothStart kStarts[] = {kWideStart, kNarrowStart, {"middle", 0.1, 0.6, kStiffTables}};
constexpr int kNumStarts = std::size(kStarts);

std::optional<SoftenedStart> Softened(int number, const Objective& few, const FactorModel& given,
                                      const StopCheck& stop, PhaseSeconds* phases) {
  if (stop()) return std::nullopt;
  if (number == kNumStarts) {
    return SoftenedStart{.name = "given", .model = Soften(few, given, {}, stop, phases)};
  }
  return SoftenedStart{.name = kStarts[number].name,
                       .model = SoftenFrom(kStarts[number], few, given, stop, phases)};
}

bool TwoAgree(const std::vector<SoftenedStart>& starts) {
  std::vector<double> E;
  for (const SoftenedStart& start : starts) E.push_back(start.E);
  return CountAgreeing(E) >= 2;
}

}  // namespace

std::span<const SmoothStart> SmoothStarts() { return kStarts; }

FactorModel SoftenFrom(const SmoothStart& start, const Objective& few, const FactorModel& given,
                       const StopCheck& stop, PhaseSeconds* phases) {
  FactorModel model = SpreadModel(few, start.narrow, start.wide);
  CopyUnobservedParameters(few.coverage(), given, &model);
  return Soften(few, model, {.stiffest = start.stiffest}, stop, phases);
}

std::vector<SoftenedStart> SoftenStarts(const Objective& objective, const FactorModel& given,
                                        const StopCheck& stop, PhaseSeconds* phases,
                                        const std::function<void(const SoftenedStart&)>& on_pair) {
  constexpr int kPair = 2;
  const int stride = StartElimination::StrideFor(objective, StartElimination::kThinned);
  const Objective few = StartElimination::Few(objective, stride);
  std::vector<SoftenedStart> starts;
  for (int first = 0; first <= kNumStarts; first += kPair) {
    std::optional<SoftenedStart> pair[kPair];
    PhaseSeconds phases_of[kPair];
    ParallelJobs(kPair, objective.num_threads(),
                 [&](int k) { pair[k] = Softened(first + k, few, given, stop, &phases_of[k]); });
    for (int k = 0; k < kPair; ++k) {
      *phases += phases_of[k];
      if (!pair[k]) continue;
      pair[k]->E = objective.Value(pair[k]->model);
      starts.push_back(*std::move(pair[k]));
    }
    if (starts.empty()) break;
    std::ranges::stable_sort(starts, {}, &SoftenedStart::E);
    on_pair(starts.front());
    if (stop() || TwoAgree(starts)) break;
  }
  return starts;
}

}  // namespace trilobe
