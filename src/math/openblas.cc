#include "trilobe/math/openblas.h"

#include <dlfcn.h>

#include <cstdlib>
#include <mutex>
#include <string_view>

namespace trilobe {
namespace {

// A function of OpenBLAS, null where BLAS is another one, or lacks it.
template <typename Function>
Function* OfOpenBlas(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

// OpenBLAS takes a processor that is newer than itself for one of 2004 (Debian's 0.3.21 does so
// with Intel's of 2023), whose kernels are a quarter as fast. The kernels for what the processor
// says that it has, or null.
const char* BetterKernels() {
#if defined(__x86_64__)
  auto* const name = OfOpenBlas<char*()>("openblas_get_corename");
  if (name == nullptr || std::getenv("OPENBLAS_CORETYPE") != nullptr) return nullptr;
  const std::string_view kernels = name();
  if (kernels != "Prescott" && kernels != "Barcelona") return nullptr;  // Intel's, AMD's
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
    return "SkylakeX";
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
#endif
  return nullptr;
}

// Threads are ours, and bits must not hang on how many OpenBLAS has: one. Before main, since Ceres
// calls BLAS, too. True where OpenBLAS is built without threads: then it hands the same work space
// to two callers at once (0.3.21 looks for a free one outside of its lock), whose results are
// wrong.
const bool only_one_caller = [] {
  if (auto* const set = OfOpenBlas<void(int)>("openblas_set_num_threads")) set(1);
  auto* const quit = OfOpenBlas<void()>("gotoblas_dynamic_quit");
  auto* const init = OfOpenBlas<void()>("gotoblas_dynamic_init");
  if (const char* const kernels = BetterKernels(); kernels && quit && init) {
    // It chooses its kernels once more, as its users would have it do.
    setenv("OPENBLAS_CORETYPE", kernels, /*overwrite=*/1);
    quit();
    init();
    unsetenv("OPENBLAS_CORETYPE");
  }
  auto* const parallel = OfOpenBlas<int()>("openblas_get_parallel");
  return parallel != nullptr && parallel() == 0;
}();

}  // namespace

BlasCall::BlasCall() {
  static std::mutex mutex;
  if (only_one_caller) lock_ = std::unique_lock(mutex);
}

}  // namespace trilobe
