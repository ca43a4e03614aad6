#ifndef TRILOBE_SOLVERS_STARTS_START_ELIMINATION_H_
#define TRILOBE_SOLVERS_STARTS_START_ELIMINATION_H_

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

inline constexpr double kSameE = 0.005;  // largest relative difference of E of models that agree
// Number of starts with the least E, within kSameE. Different starts hardly agree by chance.
int CountAgreeing(const std::vector<StartResult>& starts);

// Fits several starting points to thinned samples in parallel, one thread each, and eliminates the
// worse ones. E has many local minima, and a fraction of dense samples ranks them as all do.
class StartElimination {
 public:
  // Makes a starting point; called once, from any thread. Returns nothing if there is none, or no
  // new one. May add times to *phases.
  using MakeStart = std::function<std::optional<FactorModel>(PhaseSeconds* phases)>;

  // The largest stride (Thinned) up to `max_stride` that leaves this many folded samples per
  // parameter of the model.
  struct Thinning {
    int samples_per_parameter, max_stride;
  };
  // Enough samples to rank the minima. With fewer, the fixed work per (theta_h, theta_d) dominates.
  static constexpr Thinning kThinned{.samples_per_parameter = 25, .max_stride = 24};
  // The stride of a thinning.
  static int StrideFor(const Objective& objective, const Thinning& thinning);

  // `stop` is called from several threads.
  StartElimination(const Objective& objective, const Thinning& thinning, StopCheck stop);
  ~StartElimination();

  // Continues with about twice as many samples, if these are not all.
  void ThinLess();

  // The thinned objective, with one thread unless starts take turns.
  const Objective& thinned() const { return *thinned_; }

  // Sweeps of AWLS before the first joint step of a start, which correct its magnitudes.
  struct Sweeps {
    int count = 5;
    bool in_blocks = true;
  };
  // Adds a start. With a reduction, which must outlive this, the start must be B y for some y, and
  // steps are in y.
  void Enter(std::string name, MakeStart make_start, Sweeps sweeps,
             const Reduction* reduction = nullptr);
  void Enter(std::string name, MakeStart make_start) {
    Enter(std::move(name), std::move(make_start), Sweeps());
  }

  // Ranks the last added start as if its E were larger by this fraction.
  void RankLastBehind(double share);

  // Advances the remaining starts to a total of `tries` tried joint steps after their sweeps. A
  // start stops earlier if it has converged or the run is to stop. A start not begun by then is
  // never begun. `on_ended` is called after each with how many have ended, and of how many; one
  // call at a time, from any thread.
  void Advance(
      int tries, const std::function<void(int ended, int starts)>& on_ended = [](int, int) {});

  // Eliminates all but the best `count`.
  void Keep(int count);

  // The best model of all starts so far; null if there is none.
  const FactorModel* leader() const;

  // All begun starts by rank, with E on all samples estimated from the thinned ones.
  std::vector<StartResult> Results() const;

  // The models of Results(), in the same order.
  std::vector<const FactorModel*> Models() const;

  // Times summed over the starts, which run in parallel.
  PhaseSeconds phases() const;

 private:
  class Candidate;
  // Sets thinned_: one in stride_ of the samples; on a grid, one in stride_ / 2 of phi_d of every
  // other (theta_h, theta_d), since a row of few samples takes as long as one of eight.
  void Thin();
  // Whether starts take turns, each on all threads: what a step keeps of so many samples takes much
  // memory.
  bool TakesTurns() const;
  std::vector<Candidate*> Ranked() const;

  const Objective& objective_;
  const StopCheck stop_;
  int stride_;  // that samples are thinned by
  std::unique_ptr<const Objective> thinned_;
  std::vector<std::unique_ptr<Candidate>> candidates_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_STARTS_START_ELIMINATION_H_
