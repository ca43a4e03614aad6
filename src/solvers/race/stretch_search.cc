#include "trilobe/solvers/race/stretch_search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "trilobe/base/parallel.h"
#include "trilobe/solvers/joint/joint_step.h"
#include "trilobe/solvers/race/start_race.h"

namespace trilobe {
namespace {

constexpr double kUnits = 20;  // exponents are whole numbers of twentieths
constexpr int kFirstStep = 8;
constexpr int kJointSteps = 3;  // at each point

struct Point {
  FactorModel model;
  double E;
};

Point FitAt(const Objective& thinned, const FactorModel& start, const std::function<bool()>& stop) {
  const Objective objective(thinned, start.spec());
  PhaseSeconds phases;
  JointStepper stepper(objective, JointStepper::Curvature::kByProgress,
                       JointStepper::Trial::kProjected, &phases);
  stepper.Restart(start);
  for (int k = 0; k < kJointSteps && !stepper.exhausted() && !stop(); ++k) stepper.Step();
  return {stepper.current(), stepper.E()};
}

struct Place {
  int along = 0, across = 0;
  Stretch stretch() const { return {.along = along / kUnits, .across = across / kUnits}; }
  bool operator==(const Place&) const = default;
};

}  // namespace

FactorModel WithStretch(const FactorModel& model, const Stretch& stretch) {
  ModelSpec spec = model.spec();
  spec.stretch = stretch;
  FactorModel result(spec);
  std::ranges::copy(model.parameters(), result.parameters().begin());
  return result;
}

FactorModel FitStretch(const Objective& objective, const FactorModel& fitted,
                       const std::function<bool()>& stop) {
  constexpr StartRace::Thinning kThinned{.samples_per_parameter = 8, .max_stride = 72};
  const StartRace race(objective, kThinned, stop);
  Point best = FitAt(race.thinned(), fitted, stop);
  Place at;
  std::vector<Place> tried = {at};
  for (int step = kFirstStep; step >= 1 && !stop();) {
    std::vector<Place> around;
    for (const Place& to : {Place{at.along - step, at.across},
                            {at.along + step, at.across},
                            {at.along, at.across - step},
                            {at.along, at.across + step}}) {
      const bool within = std::max(std::abs(to.along), std::abs(to.across)) <= kMaxStretch * kUnits;
      if (!within || std::ranges::find(tried, to) != tried.end()) continue;
      around.push_back(to);
      tried.push_back(to);
    }
    std::vector<std::optional<Point>> points(around.size());
    ParallelFor(static_cast<int>(around.size()), objective.num_threads(), [&](int k) {
      if (stop()) return;
      points[k] = FitAt(race.thinned(), WithStretch(best.model, around[k].stretch()), stop);
    });
    const auto lowest = std::ranges::min_element(
        points, {}, [](const std::optional<Point>& point) { return point ? point->E : HUGE_VAL; });
    if (lowest != points.end() && *lowest && (*lowest)->E < best.E) {
      at = around[lowest - points.begin()];
      best = **lowest;
    } else {
      step /= 2;
    }
  }
  return best.model;
}

}  // namespace trilobe
