#include "solvers/starts/stiff_starts.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "model/objective/gauge.h"
#include "model/objective/lobes.h"
#include "solvers/starts/start_elimination.h"
#include "trilobe/core/system/parallel.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe {
namespace {

// The widest, which has the longest way, begins stiffer.
constexpr StiffStart kWide{"wide", 0.2, 0.6, 10 * kStiffTables};
constexpr StiffStart kNarrow{"narrow", 0.02, 0.2, kStiffTables};
constexpr StiffStart kStiffStarts[] = {kWide, kNarrow, {"middle", 0.1, 0.6, kStiffTables}};

// Starts from the widest lobes to the narrowest, and two that have both. Coarse samples tell which
// of them ends lowest on few samples: docs/decisions/multistart.md.
constexpr StiffStart kCoarseStarts[] = {
    kWide, kNarrow, {"spread", 0.02, 0.6, kStiffTables}, {"broad", 0.05, 0.6, 10 * kStiffTables}};
constexpr int kNumCoarseStarts = std::size(kCoarseStarts);

constexpr double kStillStiff = 1e-6;  // where half the entries are enough

// Tables keep four entries at least.
bool CanBeHalved(const Objective& objective) {
  constexpr int kLeast = 8;
  const ModelSpec& spec = objective.spec();
  if (!objective.on_grid() || spec.anisotropic() || spec.stretches.any()) return false;
  const BrdfSamples& samples = objective.samples();
  const int sizes[] = {samples.grid.theta_h, samples.grid.theta_d, spec.d_axis.size,
                       spec.f_axis.size, spec.g_axis.size};
  return std::ranges::all_of(sizes, [](int size) { return size % 2 == 0 && size >= kLeast; });
}

}  // namespace

std::span<const StiffStart> StiffStarts() { return kStiffStarts; }

FactorModel SoftenStart(const StiffStart& start, const Objective& few, const FactorModel& given,
                        const StopCheck& stop, PhaseSeconds* phases) {
  FactorModel model = SpreadModel(few, start.narrow, start.wide);
  CopyUnobservedParameters(few.coverage(), given, &model);
  return Soften(few, model, {.stiffest = start.stiffest}, stop, phases);
}

std::optional<Objective> CoarseObjective(const Objective& objective) {
  const bool plenty = StartElimination::StrideFor(objective, StartElimination::kThinned) > 1;
  if (!plenty || !CanBeHalved(objective)) return std::nullopt;
  constexpr int kOfRow = 8;  // of phi_d, with their mirrors: a row of fewer takes as long
  const int stride = std::max(1, objective.samples().grid.phi_d / 2 / kOfRow);
  BrdfSamples means = MeansOfFourBins(objective.samples(), stride);
  if (means.size() == 0) return std::nullopt;
  ModelSpec spec = objective.spec();
  for (Axis* const axis : {&spec.d_axis, &spec.f_axis, &spec.g_axis}) axis->size /= 2;
  return Objective(std::move(means), spec, objective.weighting(), /*num_threads=*/1);
}

std::vector<CoarseStart> SoftenCoarseStarts(const Objective& coarse, int num_threads,
                                            const StopCheck& stop, PhaseSeconds* phases) {
  constexpr double kSame = 0.003;
  std::optional<CoarseStart> made[kNumCoarseStarts];
  PhaseSeconds phases_of[kNumCoarseStarts];
  ParallelJobs(kNumCoarseStarts, num_threads, [&](int k) {
    if (stop()) return;
    const StiffStart& start = kCoarseStarts[k];
    const StiffnessSchedule schedule{.stiffest = start.stiffest, .softest = kStillStiff};
    FactorModel model = Soften(coarse, SpreadModel(coarse, start.narrow, start.wide), schedule,
                               stop, &phases_of[k]);
    const double E = coarse.Value(model);
    made[k] = {.name = start.name, .model = std::move(model), .E = E};
  });
  std::vector<CoarseStart> starts;
  for (int k = 0; k < kNumCoarseStarts; ++k) {
    *phases += phases_of[k];
    if (made[k]) starts.push_back(*std::move(made[k]));
  }
  std::ranges::stable_sort(starts, {}, &CoarseStart::E);
  std::vector<CoarseStart> different, again;
  for (CoarseStart& start : starts) {
    const bool same = !different.empty() && start.E <= (1 + kSame) * different.back().E;
    (same ? again : different).push_back(std::move(start));
  }
  std::ranges::move(again, std::back_inserter(different));
  return different;
}

FactorModel SoftenFurther(const CoarseStart& start, const Objective& few, const FactorModel& given,
                          const StopCheck& stop, PhaseSeconds* phases) {
  FactorModel model = WithAxes(start.model, few.spec());
  CopyUnobservedParameters(few.coverage(), given, &model);
  return Soften(few, model, {.stiffest = kStillStiff}, stop, phases);
}

}  // namespace trilobe
