#ifndef TRILOBE_CORE_ALGEBRA_OPENBLAS_H_
#define TRILOBE_CORE_ALGEBRA_OPENBLAS_H_

namespace trilobe {

// Must be held while BLAS or LAPACK is called, once per thread. With OpenBLAS, a program that links
// this file uses one BLAS thread, and kernels for its processor's vectors (openblas.cc). Waits
// while the maximum number of callers is active: at least the number of processors unless memory is
// short. Throws Error if memory is too short for a single call.
class BlasCall {
 public:
  BlasCall();
  ~BlasCall();
  BlasCall(const BlasCall&) = delete;
  BlasCall& operator=(const BlasCall&) = delete;
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_OPENBLAS_H_
