#include "core/algebra/add_to.h"

#include "core/base/multiversion.h"

namespace trilobe {

TRILOBE_MULTIVERSION
void AddTo(size_t size, const double* __restrict x, double* __restrict sum) {
  for (size_t n = 0; n < size; ++n) sum[n] += x[n];
}

}  // namespace trilobe
