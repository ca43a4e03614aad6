#include "fit/finish/without_rings.h"

#include <utility>

#include "fit/finish/albedo_ripple.h"
#include "fit/finish/smoothest.h"

namespace trilobe {

bool HasRings(const FactorModel& model, int num_threads) {
  return RippleOf(model, num_threads).share > kSeenRipple;
}

std::optional<FactorModel> WithoutRings(const Objective& objective, const FactorModel& model,
                                        const std::function<bool(const FactorModel&)>& acceptable,
                                        const StopCheck& stop) {
  constexpr double kShares[] = {0.1, 0.3, 1};
  const int num_threads = objective.num_threads();
  if (!HasRings(model, num_threads)) return std::nullopt;
  const auto is_better = [&](const FactorModel& smooth) {
    return !HasRings(smooth, num_threads) && acceptable(smooth);
  };
  for (const double share : kShares) {
    if (stop()) break;
    std::optional<SmoothedModel> smooth = Smoothest(objective, model, share, is_better, stop);
    if (smooth) return std::move(smooth->model);
  }
  return std::nullopt;
}

}  // namespace trilobe
