#include "trilobe/math/openblas.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace trilobe {
namespace {

// What this processor's kernels are called by OpenBLAS, empty where BLAS is another one.
std::string Kernels() {
  const BlasCall call;  // so that what sets OpenBLAS up is linked
  auto* const name = reinterpret_cast<char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  return name == nullptr ? "" : name();
}

TEST(OpenBlas, HasOneThread) {
  auto* const threads =
      reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
  if (Kernels().empty() || threads == nullptr) GTEST_SKIP() << "BLAS is not OpenBLAS";
  EXPECT_EQ(threads(), 1);
}

#if defined(__x86_64__)
TEST(OpenBlas, HasTheVectorsOfTheProcessor) {
  if (Kernels().empty()) GTEST_SKIP() << "BLAS is not OpenBLAS";
  if (std::getenv("OPENBLAS_CORETYPE") != nullptr) GTEST_SKIP() << "its kernels are chosen";
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) {
    GTEST_SKIP() << "the processor has none of the longer ones";
  }
  EXPECT_NE(Kernels(), "Prescott");
  EXPECT_NE(Kernels(), "Barcelona");
}
#endif

}  // namespace
}  // namespace trilobe
