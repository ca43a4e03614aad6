#ifndef TRILOBE_SOLVERS_SWEEPS_H_
#define TRILOBE_SOLVERS_SWEEPS_H_

#include <chrono>
#include <functional>
#include <string>

#include "trilobe/solvers/solver.h"

namespace trilobe {

// What all sweeping solvers share: repeats `sweep`, which updates every parameter of its argument
// once, applies the filter on G where the options ask for it, keeps the trace and the best model,
// and stops. The clock has been running since `start`.
SolverSummary RunSweeps(const std::string& solver, const Objective& objective,
                        const SolverOptions& options,
                        const std::function<void(FactorModel*)>& sweep,
                        std::chrono::steady_clock::time_point start, FactorModel* model);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_SWEEPS_H_
