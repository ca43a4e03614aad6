#ifndef TRILOBE_SOLVERS_AWLS_MAKE_SWEEP_H_
#define TRILOBE_SOLVERS_AWLS_MAKE_SWEEP_H_

#include <memory>

#include "solvers/awls/sweep.h"

namespace trilobe {

// From exact sums where samples are on a grid (GridSweep), else from the samples (SampleSweep).
// Times go to *phases.
std::unique_ptr<Sweep> MakeSweep(const Objective& objective, PhaseSeconds* phases);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_MAKE_SWEEP_H_
