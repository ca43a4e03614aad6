#ifndef TRILOBE_SOLVERS_AWLS_SWEEP_H_
#define TRILOBE_SOLVERS_AWLS_SWEEP_H_

#include <functional>
#include <memory>

#include "trilobe/model/factor_model.h"
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
  void InBlocks(const IterationRecord& last, const OnElement& on_block, FactorModel* model);

  // Updates those blocks once, and not G. E: of the model as it comes.
  void Project(double E, FactorModel* model) { UpdateBlocks(E, 1, nullptr, model); }

 protected:
  // `rounds`: how often InBlocks updates the blocks.
  explicit Sweep(int rounds) : rounds_(rounds) {}
  virtual void UpdateBlocks(double E, int rounds, const OnElement& on_block,
                            FactorModel* model) = 0;
  virtual void UpdateG(const OnElement& on_element, FactorModel* model) = 0;

 private:
  const int rounds_;
};

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_SWEEP_H_
