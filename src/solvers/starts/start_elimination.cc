#include "solvers/starts/start_elimination.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <utility>

#include "solvers/joint/joint_step.h"
#include "solvers/sweep.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/core/system/parallel.h"

namespace trilobe {
namespace {

// A step that lowers E by less than this fraction ends a candidate's fit.
constexpr double kSmallDecrease = 1e-5;

}  // namespace

int CountAgreeing(const std::vector<StartResult>& starts) {
  if (starts.empty()) return 0;
  const double most =
      (1 + kSameE) * std::ranges::min(starts, {}, &StartResult::objective).objective;
  return static_cast<int>(std::ranges::count_if(
      starts, [most](double E) { return E <= most; }, &StartResult::objective));
}

int StartElimination::StrideFor(const Objective& objective, const Thinning& thinning) {
  // Folded samples are half as many.
  const int fold = objective.on_grid() ? 2 : 1;
  const int wanted = fold * thinning.samples_per_parameter * objective.spec().num_parameters();
  return std::clamp(objective.num_samples() / std::max(wanted, 1), 1, thinning.max_stride);
}

class StartElimination::Candidate {
 public:
  Candidate(std::string name, MakeStart make_start, Sweeps sweeps, const Reduction* reduction,
            const Objective* objective)
      : name_(std::move(name)),
        make_start_(std::move(make_start)),
        sweeps_(sweeps),
        reduction_(reduction),
        objective_(objective) {}

  // Goes on with other samples.
  void MoveTo(const Objective* objective) {
    objective_ = objective;
    stepper_.reset();
    converged_ = false;
    if (model_) E_ = Evaluate();
  }

  void Advance(int tries, const StopCheck& stop) {
    if (stop()) return;
    if (make_start_) Start(stop);
    if (!model_ || tries_ >= tries || stop()) return;
    if (!stepper_) {
      stepper_ = std::make_unique<JointStepper>(
          *objective_, JointStepper::Curvature::kByProgress,
          reduction_ == nullptr ? JointStepper::Trial::kProjected : JointStepper::Trial::kAsItIs,
          &phases_, reduction_);
      stepper_->Restart(*model_);
    }
    while (tries_ < tries && !converged_ && !stop()) {
      const double before = stepper_->E();
      const bool accepted = stepper_->Step();
      ++tries_;
      converged_ = stepper_->exhausted() || (accepted && !stepper_->held_back() &&
                                             stepper_->E() > (1 - kSmallDecrease) * before);
    }
    model_ = stepper_->current();
    E_ = stepper_->E();
    stepper_->ReleaseScratch();  // others' turn may come
  }

  void Leave() {
    active_ = false;
    stepper_.reset();
  }

  const std::string& name() const { return name_; }
  bool started() const { return model_.has_value(); }
  bool active() const { return active_; }
  const FactorModel& model() const { return *model_; }
  double E() const { return E_; }
  double RankedE() const { return (1 + behind_) * E_; }
  void RankBehind(double share) { behind_ = share; }
  const PhaseSeconds& phases() const { return phases_; }

 private:
  void Start(const StopCheck& stop) {
    model_ = std::exchange(make_start_, nullptr)(&phases_);
    if (!model_) {
      Leave();
      return;
    }
    E_ = Evaluate();
    const std::unique_ptr<Sweep> sweep = MakeSweep(*objective_, &phases_);
    for (int k = 0; k < sweeps_.count && !stop(); ++k) {
      if (sweeps_.in_blocks) {
        sweep->SweepInBlocks({.iteration = k, .objective = E_}, nullptr, &*model_);
        E_ = Evaluate();  // which blocks need to know
      } else {
        (*sweep)(nullptr, &*model_);
      }
    }
    if (!sweeps_.in_blocks) E_ = Evaluate();
  }

  double Evaluate() {
    const ScopedTimer timer(&phases_.evaluating);
    return objective_->Value(*model_);
  }

  const std::string name_;
  MakeStart make_start_;  // until it has been asked
  const Sweeps sweeps_;
  const Reduction* const reduction_;  // null: none
  const Objective* objective_;
  std::optional<FactorModel> model_;
  double E_ = 0, behind_ = 0;
  int tries_ = 0;
  bool active_ = true, converged_ = false;
  PhaseSeconds phases_;
  std::unique_ptr<JointStepper> stepper_;
};

StartElimination::StartElimination(const Objective& objective, const Thinning& thinning,
                                   StopCheck stop)
    : objective_(objective), stop_(std::move(stop)), stride_(StrideFor(objective, thinning)) {
  Thin();
}

void StartElimination::Thin() {
  if (stride_ == 1) {
    thinned_ =
        std::make_unique<Objective>(objective_.Alone(TakesTurns() ? objective_.num_threads() : 1));
    return;
  }
  const bool by_rows = objective_.on_grid();
  thinned_ = std::make_unique<Objective>(
      by_rows ? InEveryOtherRow(objective_.Thinned(stride_ / 2)) : objective_.Thinned(stride_),
      objective_.spec(), objective_.weighting(), /*num_threads=*/1);
}

bool StartElimination::TakesTurns() const {
  constexpr int kMany = 200'000;
  return stride_ == 1 && !objective_.on_grid() && objective_.num_samples() >= kMany;
}

void StartElimination::ThinLess() {
  if (stride_ == 1) return;
  stride_ /= 2;
  const auto before = std::exchange(thinned_, nullptr);  // lives until no candidate refers to it
  Thin();
  ParallelFor(static_cast<int>(candidates_.size()), objective_.num_threads(),
              [&](int k) { candidates_[k]->MoveTo(thinned_.get()); });
}

StartElimination::~StartElimination() = default;

void StartElimination::Enter(std::string name, MakeStart make_start, Sweeps sweeps,
                             const Reduction* reduction) {
  candidates_.push_back(std::make_unique<Candidate>(std::move(name), std::move(make_start), sweeps,
                                                    reduction, thinned_.get()));
}

void StartElimination::RankLastBehind(double share) { candidates_.back()->RankBehind(share); }

void StartElimination::Advance(int tries, const std::function<void(int, int)>& on_ended) {
  std::vector<Candidate*> active;
  for (const auto& candidate : candidates_) {
    if (candidate->active()) active.push_back(candidate.get());
  }
  const int count = static_cast<int>(active.size());
  std::mutex mutex;
  int ended = 0;
  ParallelJobs(count, TakesTurns() ? 1 : objective_.num_threads(), [&](int k) {
    active[k]->Advance(tries, stop_);
    const std::lock_guard<std::mutex> lock(mutex);
    on_ended(++ended, count);
  });
}

void StartElimination::Keep(int count) {
  int kept = 0;
  for (Candidate* const candidate : Ranked()) {
    if (candidate->active() && kept++ >= count) candidate->Leave();
  }
}

const FactorModel* StartElimination::leader() const {
  const std::vector<Candidate*> ranked = Ranked();
  return ranked.empty() ? nullptr : &ranked.front()->model();
}

std::vector<StartResult> StartElimination::Results() const {
  const double energy = thinned_->MeasuredEnergy();
  const double scale = energy > 0 ? objective_.MeasuredEnergy() / energy : 1;
  std::vector<StartResult> results;
  for (const Candidate* const candidate : Ranked()) {
    results.push_back({.name = candidate->name(), .objective = scale * candidate->E()});
  }
  return results;
}

std::vector<const FactorModel*> StartElimination::Models() const {
  std::vector<const FactorModel*> models;
  for (const Candidate* const candidate : Ranked()) models.push_back(&candidate->model());
  return models;
}

PhaseSeconds StartElimination::phases() const {
  PhaseSeconds sum;
  for (const auto& candidate : candidates_) sum += candidate->phases();
  return sum;
}

// Best first; of equals the one that entered first.
std::vector<StartElimination::Candidate*> StartElimination::Ranked() const {
  std::vector<Candidate*> ranked;
  for (const auto& candidate : candidates_) {
    if (candidate->started()) ranked.push_back(candidate.get());
  }
  std::ranges::stable_sort(ranked, {}, &Candidate::RankedE);
  return ranked;
}

}  // namespace trilobe
