#include "solvers/awls/sweep.h"

namespace trilobe {

void Sweep::InBlocks(const IterationRecord& last, const OnElement& on_block, FactorModel* model) {
  // What other parameters do to E: docs/solvers.md.
  constexpr int kElementSweeps = 3;
  if (last.iteration < kElementSweeps) {
    (*this)(on_block, model);
    return;
  }
  UpdateBlocks(last.minimised(), rounds_, on_block, model);
  UpdateG(on_block, model);
}

}  // namespace trilobe
