#ifndef TRILOBE_SOLVERS_AWLS_SWEEP_H_
#define TRILOBE_SOLVERS_AWLS_SWEEP_H_

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "solvers/sums/block_equations.h"
#include "solvers/sums/cached_lookups.h"
#include "solvers/sums/grid/cell_sums.h"
#include "solvers/sums/grid/shadowing_sums.h"
#include "solvers/sums/shadowing_updates.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_samples.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/run.h"

namespace trilobe {

// Sweeps of AWLS (paper 2.3) over all parameters of a model, each put where E is lowest with the
// others held, in the order d, s, D, F, G.
class Sweep {
 public:
  using OnElement = std::function<void(const FactorModel&)>;

  virtual ~Sweep() = default;

  // Updates every parameter once. `on_element`, if set, sees the model after each.
  virtual void operator()(const OnElement& on_element, FactorModel* model) = 0;

  // Updates d, s, D, F in blocks several times, and every node of G once. The blocks, in each of
  // which E is quadratic (SolveNonnegativeLeastSquares): d and s of one channel, then an entry of D
  // of all lobes, then one of F. The first sweeps of a run go element by element all the same: as
  // long as G is far off, exact blocks settle too early which lobe is what. `last` is the record of
  // the model as it comes. `on_block`, if set, sees it after each block and node.
  void SweepInBlocks(const IterationRecord& last, const OnElement& on_block, FactorModel* model);

  // Updates those blocks once, and not G. E: of the model as it comes.
  void Project(double E, FactorModel* model) { UpdateBlocks(E, 1, nullptr, model); }

 protected:
  // `rounds`: how often SweepInBlocks updates the blocks.
  explicit Sweep(int rounds) : rounds_(rounds) {}
  virtual void UpdateBlocks(double E, int rounds, const OnElement& on_block,
                            FactorModel* model) = 0;
  virtual void UpdateG(const OnElement& on_element, FactorModel* model) = 0;

 private:
  const int rounds_;
};

// Sweeps from exact sums, on a grid: the same element updates in the same order as the reference,
// but with one pass over the samples for d, s, D, F (CellSums) and one for each table of G
// (ShadowingSums), instead of one for each element's share of them. Several rounds of blocks take
// no further pass.
class GridSweep : public Sweep {
 public:
  // The objective, which must outlive the sweep, has its samples on a grid. Times go to *phases.
  GridSweep(const Objective& objective, PhaseSeconds* phases);

  void operator()(const OnElement& on_element, FactorModel* model) override;

 private:
  void UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) override;
  void UpdateG(const OnElement& on_element, FactorModel* model) override;
  void AccumulateCells(const FactorModel& model);

  const Objective& objective_;
  PhaseSeconds* const phases_;
  CellSums cells_;
  std::optional<ShadowingSums> shadowing_;  // once G is updated; projections do without
};

// Sweeps from the samples themselves, whatever tables they read and where: the same element updates
// in the same order as the reference. E is quadratic in d and s, in F, and in the tables of D that
// are read by one stretch, so that one pass over the samples for each gives sums from which all of
// its elements can be updated (BlockEquations). G goes node by node (ShadowingUpdates).
class SampleSweep : public Sweep {
 public:
  SampleSweep(const FoldedSamples& samples, const ModelSpec& spec, int num_threads,
              PhaseSeconds* phases);

  void operator()(const OnElement& on_element, FactorModel* model) override;

 private:
  // Where lobes are read by different stretches, an entry of D of those that share one is a block.
  void UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) override;
  void UpdateG(const OnElement& on_element, FactorModel* model) override;

  // Reads and sums around the model, calls `update`, which moves it, and reads what has moved.
  void UpdateFrom(BlockEquations* sums, FactorModel* model, const std::function<void()>& update);

  PhaseSeconds* const phases_;
  CachedLookups lookups_;
  // Of amplitudes, of the tables of D that follow each other and are read by one stretch, and of F.
  std::vector<BlockEquations> sums_;
  ShadowingUpdates shadowing_;
};

// From exact sums where samples are on a grid (GridSweep), else from the samples (SampleSweep).
// Times go to *phases.
std::unique_ptr<Sweep> MakeSweep(const Objective& objective, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_SWEEP_H_
