#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "model/objective/gauge.h"
#include "solvers/joint/dogleg.h"
#include "solvers/joint/joint_step.h"
#include "solvers/starts/minima.h"
#include "solvers/starts/start_elimination.h"
#include "solvers/starts/stiff_starts.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/solvers/run.h"
#include "trilobe/solvers/starts/initial_model.h"

namespace trilobe {
namespace {

// Thinning for anisotropic models, whose steps cost more by their parameters than by their samples.
constexpr StartElimination::Thinning kThinnedMore{.samples_per_parameter = 6, .max_stride = 24};

// The starts, in the order in which they enter: the given one first.
class Starts {
 public:
  // Coarse starts, by the samples `coarse` if there are any, are made at once.
  Starts(const Objective& objective, const std::optional<Objective>& coarse,
         const FactorModel& given, uint64_t seed, StartElimination* elimination, StopCheck stop)
      : objective_(objective),
        given_(given),
        seed_(seed),
        elimination_(elimination),
        stop_(std::move(stop)) {
    if (coarse) coarse_ = SoftenCoarseStarts(*coarse, objective.num_threads(), stop_, &phases_);
  }

  // Time spent before any start entered.
  const PhaseSeconds& phases() const { return phases_; }

  // Enters more of them, until there have been `count`.
  void EnterUpTo(size_t count) {
    for (; entered_ < count; ++entered_) EnterOne(entered_);
  }

 private:
  // Ordered by gain over time taken (docs/solvers.md).
  static constexpr std::array<std::string_view, 9> kByCoarse = {
      "given",  "coarse",   "highlight", "coarse", "coarse",
      "coarse", "analytic", "roughness", "swept"};
  static constexpr std::array<std::string_view, 8> kIsotropic = {
      "given", "wide", "narrow", "highlight", "middle", "analytic", "roughness", "swept"};
  static constexpr std::array<std::string_view, 8> kAnisotropic = {
      "given", "freed", "moments", "highlight", "analytic", "roughness", "roughness", "swept"};

  std::span<const std::string_view> Names() const {
    if (objective_.spec().anisotropic()) return kAnisotropic;
    if (coarse_.empty()) return kIsotropic;
    return kByCoarse;
  }

  void EnterOne(size_t number) {
    const std::span<const std::string_view> names = Names();
    const std::string_view name = number < names.size()              ? names[number]
                                  : (number - names.size()) % 2 == 0 ? "dogleg"
                                                                     : "roughness";
    const auto stiff = std::ranges::find(StiffStarts(), name, &StiffStart::name);
    if (name == "given") {
      elimination_->Enter("given", [this](PhaseSeconds*) { return given_; });
      // If it agrees with a start that does not depend on it, that one goes on, whatever is given.
      if (!coarse_.empty()) elimination_->RankLastBehind(kSameE);
    } else if (stiff != StiffStarts().end()) {
      EnterStiff(*stiff);
    } else if (name == "coarse") {
      EnterCoarse();
    } else if (name == "swept") {
      EnterSwept();
    } else if (name == "roughness") {
      const uint64_t seed = seed_ + random_++;
      EnterInitial(name, seed, "roughness/" + std::to_string(seed));
    } else if (name == "dogleg") {
      EnterDogleg(seed_ + random_++);
    } else {
      EnterInitial(name, seed_, std::string(name));
    }
  }

  // Its tables have softened before it enters, and it needs no sweeps.
  void EnterStiff(const StiffStart& start) {
    elimination_->Enter(start.name,
                        [this, &start](PhaseSeconds* phases) {
                          return WithUnobservedBins(
                              SoftenStart(start, elimination_->thinned(), given_, stop_, phases));
                        },
                        {.count = 0});
  }

  // The next of those that coarse samples have ranked.
  void EnterCoarse() {
    if (next_coarse_ == coarse_.size()) return;
    const CoarseStart& start = coarse_[next_coarse_++];
    elimination_->Enter(start.name,
                        [this, &start](PhaseSeconds* phases) {
                          return WithUnobservedBins(
                              SoftenFurther(start, elimination_->thinned(), given_, stop_, phases));
                        },
                        {.count = 0});
  }

  // Sweeps on from the given model as `awls` would: it creeps past minima that longer steps fall
  // into.
  void EnterSwept() {
    elimination_->Enter("swept", [this](PhaseSeconds*) { return given_; },
                        {.count = 60, .in_blocks = false});
  }

  // A random roughness, from which longer steps lead elsewhere.
  void EnterDogleg(uint64_t seed) {
    constexpr int kSteps = 60;
    elimination_->Enter(
        "dogleg/" + std::to_string(seed),
        [this, seed](PhaseSeconds* phases) {
          FactorModel model =
              WithUnobservedBins(FindInitialModel("roughness").make(objective_, seed));
          // A solver refuses to begin there; a start ends there.
          if (!std::isfinite(elimination_->thinned().Value(model))) return model;
          return AfterDoglegSteps(elimination_->thinned(), std::move(model), kSteps, stop_, phases);
        },
        {.count = 0});
  }

  void EnterInitial(std::string_view init, uint64_t seed, std::string name) {
    elimination_->Enter(
        std::move(name), [this, init, seed](PhaseSeconds*) -> std::optional<FactorModel> {
          FactorModel model = WithUnobservedBins(FindInitialModel(init).make(objective_, seed));
          if (std::ranges::equal(model.parameters(), given_.parameters())) return std::nullopt;
          return model;
        });
  }

  // Unobserved bins are the caller's, and stay.
  FactorModel WithUnobservedBins(FactorModel model) const {
    CopyUnobservedParameters(objective_.coverage(), given_, &model);
    return model;
  }

  const Objective& objective_;
  const FactorModel& given_;
  const uint64_t seed_;
  StartElimination* const elimination_;
  const StopCheck stop_;
  std::vector<CoarseStart> coarse_;
  PhaseSeconds phases_;
  size_t entered_ = 0, next_coarse_ = 0;
  uint64_t random_ = 0;  // of those, random ones
};

// A round: so many starts have entered, each that is still in goes on until it has tried so
// many joint steps, and then the best stay. A round for the undecided is skipped where two starts
// agree, and the better of these goes on alone.
struct Round {
  int starts, tries, keep;
  bool if_undecided = false;
};

// The joint steps that each round may take.
std::vector<double> StepsOf(const std::vector<Round>& rounds) {
  std::vector<double> steps;
  int entered = 0, active = 0, before = 0;
  for (const Round& round : rounds) {
    const int added = std::max(round.starts - entered, 0);
    steps.push_back(1.0 * active * (round.tries - before) + 1.0 * added * round.tries);
    entered += added;
    active = std::min(active + added, round.keep);
    before = round.tries;
  }
  return steps;
}

// Relative excess of E on all samples over the estimate from the thinned ones that counts as large,
// beyond what follows from a fit of p parameters to n values: (1 + p / n) / (1 - p / n).
constexpr double kLargeMismatch = 0.03;

// The start that is left has not been fitted to all samples; with so many steps it must have come
// below a former leader who has.
constexpr int kMaxCatchUp = 6;

double ExpectedMismatch(const Objective& thinned) {
  // Mirrored values are of the same model values.
  const double values = 3.0 * thinned.samples().size() / 2;
  return 2 * thinned.spec().num_parameters() / std::max(values, 1.0);
}

// Says after a round that has led starts to their end whether there have been enough.
using EnoughStarts = std::function<bool(const Minima&, const StartProgress&)>;

// The rounds one by one, then joint steps on all samples from the best point.
void RunRounds(const std::vector<Round>& rounds, const EnoughStarts& enough,
               const Objective& objective, const std::optional<Objective>& coarse,
               const FactorModel& given, Run* run) {
  // On all samples; a new one for each point, as the damping and the bounds of another one mislead.
  std::optional<JointStepper> stepper;
  const auto begin_at = [&](const FactorModel& model) {
    stepper.emplace(objective, JointStepper::Curvature::kByProgress,
                    JointStepper::Trial::kProjected, &run->summary().phases);
    stepper->Restart(model);
  };
  begin_at(given);
  bool go_on = run->Start(stepper->Optimality());
  if (!go_on) return;
  const auto stop = [run] { return run->IsToStop(); };
  FactorModel best = given;
  // Records the stepper's model if that is the best so far, else the best again.
  const auto record = [&] {
    const bool better = stepper->E() < run->best_objective();
    if (better) best = stepper->current();
    return run->Record(best, {.accepted = better,
                              .may_converge = false,
                              .objective = better ? stepper->E() : run->best_objective()});
  };
  {
    StartElimination elimination(
        objective, objective.spec().anisotropic() ? kThinnedMore : StartElimination::kThinned,
        stop);
    Starts starts(objective, coarse, given, run->options().seed, &elimination, stop);
    const std::vector<double> steps = StepsOf(rounds);
    const double all_steps = std::accumulate(steps.begin(), steps.end(), 0.0);
    for (const Round& round : rounds) {
      if (round.if_undecided && CountAgreeing(elimination.Results()) >= 2) {
        elimination.Keep(1);
        continue;
      }
      starts.EnterUpTo(round.starts);
      stepper->ReleaseScratch();
      const size_t number = &round - rounds.data();
      const double before = std::accumulate(steps.begin(), steps.begin() + number, 0.0);
      StartProgress progress{.round = static_cast<int>(number) + 1,
                             .rounds = static_cast<int>(rounds.size())};
      elimination.Advance(round.tries, [&](int ended, int count) {
        progress.ended = ended;
        progress.starts = count;
        progress.share = (before + steps[number] * ended / count) / all_steps;
        if (run->options().on_start) run->options().on_start(progress);
      });
      elimination.Keep(round.keep);
      for (const StartResult& start : elimination.Results()) {
        VLOG(1) << "start " << start.name << ": E " << start.objective << " by thinned samples";
      }
      if (elimination.leader() == nullptr) continue;
      // On all samples a leader may be behind its predecessor.
      begin_at(*elimination.leader());
      const double mismatch = stepper->E() / elimination.Results().front().objective - 1;
      go_on = record();
      if (!go_on) break;
      // If few bins hold most of E, as in measurements that are noisy near the horizon, a model
      // fits the thinned samples at the cost of the others.
      const bool large = mismatch > kLargeMismatch + ExpectedMismatch(elimination.thinned());
      const bool go_on_from_here = round.tries < rounds.back().tries;
      if (large && go_on_from_here) elimination.ThinLess();
      if (!enough || go_on_from_here) continue;
      if (enough(FindMinima(elimination, objective), progress)) break;
    }
    run->summary().starts =
        enough ? FindMinima(elimination, objective).starts : elimination.Results();
    run->summary().phases += starts.phases();
    run->summary().phases += elimination.phases();
  }
  for (int k = 0; k < kMaxCatchUp && go_on && stepper->E() > run->best_objective(); ++k) {
    stepper->Step();
    go_on = record();
  }
  if (!go_on) return;
  if (stepper->E() > run->best_objective()) begin_at(best);
  RepeatJointSteps(&*stepper, run);
}

class Auto : public Solver {
 public:
  static constexpr double kToleranceFactor = 10;

  static std::vector<Round> Rounds() {
    constexpr int kAsBefore = 0;
    return {{.starts = 1, .tries = 4, .keep = 1},
            {.starts = 3, .tries = 16, .keep = 3},
            {.starts = 5, .tries = 16, .keep = 4, .if_undecided = true},
            {.starts = kAsBefore, .tries = 40, .keep = 2},
            {.starts = kAsBefore, .tries = 100, .keep = 1}};
  }

  // The start that coarse samples prefer needs but one other to agree with.
  static std::vector<Round> RoundsByCoarse() {
    constexpr int kAsBefore = 0;
    return {{.starts = 2, .tries = 28, .keep = 2},
            {.starts = 4, .tries = 28, .keep = 3, .if_undecided = true},
            {.starts = kAsBefore, .tries = 40, .keep = 2},
            {.starts = kAsBefore, .tries = 100, .keep = 1}};
  }

  // A step of some two thousand parameters costs ten times as much.
  static std::vector<Round> FewRounds() {
    return {{.starts = 2, .tries = 4, .keep = 2},
            {.starts = 5, .tries = 6, .keep = 2},
            {.starts = 5, .tries = 12, .keep = 1}};
  }

  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("auto", objective, options, model);
    // A joint step on all samples gains more than an iteration of others, and costs more.
    run.summary().used.relative_decrease_tolerance *= kToleranceFactor;
    const std::optional<Objective> coarse = CoarseObjective(objective);
    const std::vector<Round> rounds = objective.spec().anisotropic() ? FewRounds()
                                      : coarse                       ? RoundsByCoarse()
                                                                     : Rounds();
    RunRounds(rounds, nullptr, objective, coarse, FactorModel(*model), &run);
    const std::vector<StartResult>& tried = run.summary().starts;
    // A few steps of an anisotropic model tell which start is best, but not whether two agree.
    if (tried.size() > 1 && !objective.spec().anisotropic()) {
      run.summary().notes.push_back(std::to_string(CountAgreeing(tried)) + " of " +
                                    std::to_string(tried.size()) + " starts agree");
    }
    return run.Finish();
  }
};

class Multistart : public Solver {
 private:
  // Leads kTogether starts at a time to their end. The first ones stop after few steps: on these
  // samples they may be misled.
  static std::vector<Round> Rounds(int starts) {
    constexpr int kTogether = 8, kFewTries = 10, kTries = 100;
    const int first = std::min(starts, kTogether);
    std::vector<Round> rounds = {{.starts = first, .tries = kFewTries, .keep = first}};
    for (int count = first; count < starts + kTogether; count += kTogether) {
      rounds.push_back({.starts = std::min(count, starts), .tries = kTries, .keep = 0});
    }
    return rounds;
  }

  SolverSummary DoSolve(const Objective& objective, const SolverOptions& options,
                        FactorModel* model) const override {
    Run run("multistart", objective, options, model);
    std::set<std::string> told;
    std::string note;
    const EnoughStarts enough = [&](const Minima& minima, StartProgress progress) {
      progress.lowest = minima.starts.front().objective;
      for (const StartResult& start : minima.starts) {
        if (!told.insert(start.name).second || !run.options().on_start) continue;
        progress.start = start;
        run.options().on_start(progress);
      }
      note = minima.Describe();
      return minima.Enough();
    };
    RunRounds(Rounds(options.starts), enough, objective, CoarseObjective(objective),
              FactorModel(*model), &run);
    if (!note.empty()) run.summary().notes.push_back(note);
    return run.Finish();
  }
};

}  // namespace

SolverEntry AutoEntry() {
  return {.name = "auto",
          .description = "as few starts as agree, all but the best eliminated on thinned data",
          .reference = "docs/solvers.md",
          .make = [] { return std::make_unique<Auto>(); }};
}

SolverEntry MultistartEntry() {
  return {.name = "multistart",
          .description = "as auto, with random starts until three agree and few minima are unseen",
          .reference = "docs/solvers.md",
          .options = {"starts", "seed"},
          .make = [] { return std::make_unique<Multistart>(); }};
}

}  // namespace trilobe
