#ifndef TRILOBE_CORE_ALGEBRA_ADD_TO_H_
#define TRILOBE_CORE_ALGEBRA_ADD_TO_H_

#include <cstddef>

namespace trilobe {

// sum += x, element by element. Both have `size` elements and do not overlap.
void AddTo(size_t size, const double* x, double* sum);

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_ADD_TO_H_
