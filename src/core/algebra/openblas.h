#ifndef TRILOBE_CORE_ALGEBRA_OPENBLAS_H_
#define TRILOBE_CORE_ALGEBRA_OPENBLAS_H_

namespace trilobe {

// To be held while BLAS or LAPACK is called, and not twice by one thread. Where BLAS is OpenBLAS, a
// program that links this has one thread of it, and kernels with the vectors that its processor has
// (openblas.cc). Waits while as many call as can at the same time: no fewer than there are
// processors, unless memory lacks. Throws Error where it lacks for a single call.
class BlasCall {
 public:
  BlasCall();
  ~BlasCall();
  BlasCall(const BlasCall&) = delete;
  BlasCall& operator=(const BlasCall&) = delete;
};

}  // namespace trilobe

#endif  // TRILOBE_CORE_ALGEBRA_OPENBLAS_H_
