#ifndef TRILOBE_SOLVERS_SWEEP_H_
#define TRILOBE_SOLVERS_SWEEP_H_

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "solvers/sums/block_equations.h"
#include "solvers/sums/cell_sums.h"
#include "solvers/sums/sample_lookups.h"
#include "solvers/sums/shadowing_sums.h"
#include "solvers/sums/shadowing_updates.h"
#include "trilobe/model/factor_model.h"
#include "trilobe/model/objective/folded_samples.h"
#include "trilobe/model/objective/iteration_record.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/run.h"

namespace trilobe {

// Sweeps of AWLS (paper 2.3) over all parameters of a model in the order d, s, D, F, G. Each is set
// to the minimum of E with the others held.
class Sweep {
 public:
  using OnElement = std::function<void(const FactorModel&)>;

  virtual ~Sweep() = default;

  // Updates every parameter once. `on_element`, if set, sees the model after each.
  virtual void operator()(const OnElement& on_element, FactorModel* model) = 0;

  // Updates d, s, D, F in blocks several times, then every node of G once. E is quadratic in each
  // block (SolveNonnegativeLeastSquares): d and s of one channel, an entry of D of all lobes, one
  // of F. The first sweeps of a run go element by element, because exact blocks settle the roles of
  // lobes too early while G is far off. `last` is the record of the given model. `on_block`, if
  // set, sees the model after each block and node.
  void SweepInBlocks(const IterationRecord& last, const OnElement& on_block, FactorModel* model);

  // Updates these blocks once, but not G. E: of the given model.
  void Project(double E, FactorModel* model) { UpdateBlocks(E, 1, nullptr, model); }

 protected:
  // `rounds`: number of updates of the blocks in SweepInBlocks.
  explicit Sweep(int rounds) : rounds_(rounds) {}
  virtual void UpdateBlocks(double E, int rounds, const OnElement& on_block,
                            FactorModel* model) = 0;
  virtual void UpdateG(const OnElement& on_element, FactorModel* model) = 0;

 private:
  const int rounds_;
};

// Sweeps with exact sums for samples on a grid. Makes the updates of the reference in the same
// order, with one pass over the samples for d, s, D, F (CellSums) and one for each table of G
// (ShadowingSums). Further rounds of blocks take no further pass.
class GridSweep : public Sweep {
 public:
  // The objective must outlive the sweep and have samples on a grid. Adds times to *phases.
  GridSweep(const Objective& objective, PhaseSeconds* phases);

  void operator()(const OnElement& on_element, FactorModel* model) override;

 private:
  void UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) override;
  void UpdateG(const OnElement& on_element, FactorModel* model) override;
  void AccumulateCells(const FactorModel& model);

  const Objective& objective_;
  PhaseSeconds* const phases_;
  CellSums cells_;
  std::optional<ShadowingSums> shadowing_;  // made at the first update of G
};

// Sweeps for any samples. Makes the updates of the reference in the same order. E is quadratic in d
// and s, in F, and in the tables of D read by one stretch; one pass over the samples for each of
// these gives the sums for all of its elements (BlockEquations). G is updated node by node
// (ShadowingUpdates).
class SampleSweep : public Sweep {
 public:
  SampleSweep(std::shared_ptr<const FoldedSamples> samples, const ModelSpec& spec, int num_threads,
              PhaseSeconds* phases);

  void operator()(const OnElement& on_element, FactorModel* model) override;

 private:
  // With several stretches, a block of D is an entry of the lobes that share one.
  void UpdateBlocks(double E, int rounds, const OnElement& on_block, FactorModel* model) override;
  void UpdateG(const OnElement& on_element, FactorModel* model) override;

  // Accumulates sums at the model, calls `update`, which moves it, and reads the moved tables.
  void UpdateFrom(BlockEquations* sums, FactorModel* model, const std::function<void()>& update);

  PhaseSeconds* const phases_;
  const std::shared_ptr<const FoldedSamples> samples_;
  SampleLookups lookups_;
  // Sums for amplitudes, for each range of tables of D that one stretch reads, and for F.
  std::vector<BlockEquations> sums_;
  ShadowingUpdates shadowing_;
};

// A GridSweep if the samples are on a grid, else a SampleSweep. Adds times to *phases.
std::unique_ptr<Sweep> MakeSweep(const Objective& objective, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SWEEP_H_
