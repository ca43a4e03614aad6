#include "core/algebra/eigenvalues.h"

#include <algorithm>

#include "core/algebra/openblas.h"
#include "trilobe/core/base/error.h"

// LAPACK has no C header of its own.
extern "C" void dsyev_(const char* jobz, const char* uplo, const int* n, double* A, const int* lda,
                       double* w, double* work, const int* lwork, int* info);

namespace trilobe {

std::vector<double> SymmetricEigenvalues(int n, std::vector<double> A) {
  std::vector<double> values(n);
  if (n == 0) return values;
  const BlasCall call;
  int info = 0, size = -1;
  double best_size = 0;
  dsyev_("N", "L", &n, A.data(), &n, values.data(), &best_size, &size, &info);
  size = std::max(3 * n, static_cast<int>(best_size));
  std::vector<double> work(size);
  dsyev_("N", "L", &n, A.data(), &n, values.data(), work.data(), &size, &info);
  if (info != 0) throw Error("the eigenvalues of a matrix did not converge");
  return values;
}

}  // namespace trilobe
