#ifndef TRILOBE_SOLVERS_STARTS_MINIMA_H_
#define TRILOBE_SOLVERS_STARTS_MINIMA_H_

#include <string>
#include <vector>

#include "solvers/starts/start_elimination.h"
#include "trilobe/model/objective/objective.h"
#include "trilobe/solvers/solver.h"

namespace trilobe {

// The minima in which starts have ended. Two have ended in the same one if their E differs by at
// most kSameMinimum and their lobes are alike.
struct Minima {
  static constexpr double kSameMinimum = 1e-3, kAlike = 0.9;

  std::vector<StartResult> starts;  // best first, with `minimum` filled in

  int count() const;    // of minima
  int at_best() const;  // starts that ended in the lowest

  // The expected probability that a further random start ends in a minimum that no random one has
  // ended in: w (w + 1) / (n (n - 1)), at most 1, for w minima of n random starts (Boender and
  // Rinnooy Kan 1987, "Bayesian stopping rules for multistart global optimization methods"). Other
  // starts are not drawn at random: they may agree, and tell nothing of what they miss.
  double NewMinimum() const;

  // Whether further starts are hardly worth it: three random ones have ended in the lowest minimum,
  // and a further one is unlikely to end in a new one.
  bool Enough() const;

  // Text such as "of 40 starts 3 ended in the lowest minimum; ...".
  std::string Describe() const;
};

Minima FindMinima(const StartElimination& elimination, const Objective& objective);

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_STARTS_MINIMA_H_
