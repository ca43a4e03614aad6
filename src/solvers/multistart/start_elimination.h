#ifndef TRILOBE_SOLVERS_MULTISTART_START_ELIMINATION_H_
#define TRILOBE_SOLVERS_MULTISTART_START_ELIMINATION_H_

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solvers/joint/reduction.h"
#include "trilobe/core/base/stop_check.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

inline constexpr double kSameE = 0.005;  // E of models that agree differ by this share at most

// How many have the least E, within kSameE. Two that came there from different starts are hardly
// there by chance.
int CountAgreeing(const std::vector<StartResult>& starts);

// Several starting points, fitted side by side to a thinned selection of the samples, a thread
// each: E has many local minima, which one a start leads to cannot be told beforehand, and the
// samples lie so dense that a fraction of them ranks the minima as all of them do.
class StartElimination {
 public:
  // Makes a starting point; asked once, from any thread. Nothing if there is none, or no new one.
  // Times may go to *phases.
  using MakeStart = std::function<std::optional<FactorModel>(PhaseSeconds* phases)>;

  // Samples are left out by a stride (Thinned) of at most `max_stride`, as long as so many folded
  // ones are left for each number of the model.
  struct Thinning {
    int samples_per_parameter, max_stride;
  };
  // As many samples a parameter tell the minima apart; with fewer, work that every
  // (theta_h, theta_d) takes, however few its samples, rules the time.
  static constexpr Thinning kThinned{.samples_per_parameter = 25, .max_stride = 24};
  // Every how many samples are looked at.
  static int StrideFor(const Objective& objective, const Thinning& thinning);

  // `stop` may be asked from several threads.
  StartElimination(const Objective& objective, const Thinning& thinning, StopCheck stop);
  ~StartElimination();

  // Goes on with about twice as many samples, if these are not all.
  void ThinLess();

  // The selection of samples, for one thread.
  const Objective& thinned() const { return *thinned_; }

  // What a start gets first of all: sweeps of AWLS, which bring its magnitudes in order.
  struct Sweeps {
    int count = 5;
    bool in_blocks = true;
  };
  // With a reduction, which must outlive this, a start is one of its points, and so are all steps.
  void Enter(std::string name, MakeStart make_start, Sweeps sweeps,
             const Reduction* reduction = nullptr);
  void Enter(std::string name, MakeStart make_start) {
    Enter(std::move(name), std::move(make_start), Sweeps());
  }

  // The start that entered last ranks as if its E were by this share larger.
  void RankLastBehind(double share);

  // Those that are still in go on until they have made their sweeps and then tried so many joint
  // steps. One that has converged, or is to stop, makes no more; one that has not begun by then
  // never does.
  void Advance(int tries);

  // All but the best `count` leave the elimination.
  void Keep(int count);

  // The best of all that ever entered; null if there is none yet.
  const FactorModel* leader() const;

  // All that started, as they rank, with E on the thinned samples as an estimate of that on all.
  std::vector<StartResult> Results() const;

  // Summed over the candidates, which work at the same time.
  PhaseSeconds phases() const;

 private:
  class Candidate;
  // Sets thinned_: one in stride_ of the samples, for one thread; on a grid, of every other
  // (theta_h, theta_d) one in stride_ / 2 of phi_d, since a row of few samples takes as long as one
  // of eight.
  void Thin();
  std::vector<Candidate*> Ranked() const;

  const Objective& objective_;
  const StopCheck stop_;
  int stride_;  // that samples are thinned by
  std::unique_ptr<const Objective> thinned_;
  std::vector<std::unique_ptr<Candidate>> candidates_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_MULTISTART_START_ELIMINATION_H_
