#include "core/algebra/openblas.h"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>

#include "tests/test_util.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// OpenBLAS' name for this processor's kernels; empty with another BLAS.
std::string Kernels() {
  const BlasCall call;  // so that what sets OpenBLAS up is linked
  auto* const name = reinterpret_cast<char* (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  return name == nullptr ? "" : name();
}

// Passes with another BLAS.
TEST(OpenBlas, HasOneThread) {
  const BlasCall call;
  auto* const threads =
      reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
  EXPECT_EQ(threads != nullptr ? threads() : 1, 1);
}

// OpenBLAS starts no thread when it is loaded either: the process has this one only.
TEST(OpenBlas, StartsNoThread) {
  const BlasCall call;
  const std::filesystem::directory_iterator threads("/proc/self/task");
  if (kSanitized) GTEST_SKIP() << "a sanitizer may have one";
  EXPECT_EQ(std::distance(begin(threads), end(threads)), 1);
}

#if defined(__x86_64__)
// Unless somebody asks for others.
TEST(OpenBlas, HasTheVectorsOfTheProcessor) {
  const std::string kernels = Kernels();
  const bool asked_for = std::getenv("OPENBLAS_CORETYPE") != nullptr;
  const bool has_more = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  EXPECT_FALSE(has_more && !asked_for && (kernels == "Prescott" || kernels == "Barcelona"))
      << kernels;
}
#endif

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
