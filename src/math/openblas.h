#ifndef TRILOBE_MATH_OPENBLAS_H_
#define TRILOBE_MATH_OPENBLAS_H_

#include <mutex>

namespace trilobe {

// To be held while BLAS or LAPACK is called. Where BLAS is OpenBLAS, a program that links this has
// one thread of it, and kernels with the vectors that its processor has (openblas.cc).
class BlasCall {
 public:
  BlasCall();

 private:
  std::unique_lock<std::mutex> lock_;
};

}  // namespace trilobe

#endif  // TRILOBE_MATH_OPENBLAS_H_
