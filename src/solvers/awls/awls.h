#ifndef TRILOBE_SOLVERS_AWLS_AWLS_H_
#define TRILOBE_SOLVERS_AWLS_AWLS_H_

#include "trilobe/solvers/solver.h"

namespace trilobe {

// The paper's solver with exact sums. Starting points use it; the registry lists it, too.
SolverEntry AwlsEntry();

}  // namespace trilobe

#endif  // TRILOBE_SOLVERS_AWLS_AWLS_H_
