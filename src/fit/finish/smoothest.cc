#include "fit/finish/smoothest.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "fit/finish/reflectance.h"
#include "model/objective/canonical_form.h"
#include "solvers/joint/log_stepper.h"

namespace trilobe {

std::optional<SmoothedModel> Smoothest(const Objective& objective, const FactorModel& model,
                                       double share,
                                       const std::function<bool(const FactorModel&)>& acceptable,
                                       const StopCheck& stop) {
  constexpr double kFirstStiffness = 3e-6, kMaxChange = 10, kSlope = 0.1;
  constexpr int kMaxSteps = 12, kStepsWithOne = 2;
  constexpr double kSmallDecrease = 1e-3, kLeastOfShare = 0.4, kAim = 0.85;
  constexpr double kPriceOfLight = 30;  // an error of 1 % costs 0.3 % of E
  const double E = objective.Value(model);
  if (!(share * E > 0)) return std::nullopt;
  PhaseSeconds phases;
  const ReflectancePrice price(objective, model, kPriceOfLight * E);
  LogStepper stepper(objective, &phases, kSlope);
  stepper.set_added_term(&price);
  stepper.Restart(model);
  struct Passed {
    FactorModel model;
    double E, roughness, stiffness;
  };
  std::vector<Passed> way;
  double least = E;
  double stiffness = kFirstStiffness;
  stepper.set_stiffness(stiffness);
  for (int k = 0, with_this = 0; k < kMaxSteps && !stepper.exhausted() && !stop(); ++k) {
    const double before = stepper.minimised();
    if (!stepper.Step()) continue;
    way.push_back({stepper.current(), stepper.E(), stepper.roughness(), stiffness});
    least = std::min(least, stepper.E());
    const bool little = stepper.minimised() > (1 - kSmallDecrease) * before;
    if (!little && ++with_this < kStepsWithOne) continue;
    const double rise = stepper.E() / least - 1;
    if (rise >= kLeastOfShare * share && rise <= share) break;
    // Assumes that the rise is in proportion to lambda; it grows no faster.
    const double change = kAim * share / std::max(rise, share / kMaxChange);
    stiffness *= std::clamp(change, 1 / kMaxChange, kMaxChange);
    stepper.set_stiffness(stiffness);
    with_this = 0;
  }
  std::erase_if(way, [&](const Passed& passed) { return passed.E > (1 + share) * least; });
  std::ranges::stable_sort(way, {}, &Passed::roughness);
  for (Passed& passed : way) {
    if (stop()) break;
    Canonicalize(objective, &passed.model);
    if (!acceptable(passed.model)) continue;
    return SmoothedModel{
        .model = std::move(passed.model), .rise = passed.E / E - 1, .stiffness = passed.stiffness};
  }
  return std::nullopt;
}

}  // namespace trilobe
