#include "core/algebra/openblas.h"

#include <dlfcn.h>
#include <sys/mman.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "trilobe/core/base/error.h"

// Replaces OpenBLAS's own function, which reads the number of threads from the environment when it
// is loaded and otherwise starts one per processor. These threads would have no work; but if their
// memory is short they never end, and the program waits for them at exit. Must be among the dynamic
// symbols of a program (src/CMakeLists.txt). Weak, as a static OpenBLAS has its own.
extern "C" [[gnu::weak, gnu::used]] int openblas_num_threads_env() { return 1; }

namespace trilobe {
namespace {

// A function of OpenBLAS; null for other BLAS libraries, or if it does not exist.
template <typename Function>
Function* OfOpenBlas(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_DEFAULT, name));
}

// OpenBLAS treats a processor newer than itself as one of 2004 (Debian's 0.3.21 does so with
// Intel's of 2023), whose kernels are a quarter as fast. Returns kernels that fit the processor's
// features, or null.
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

// Sets OpenBLAS to one thread: we have our own, and results must not depend on its number of
// threads. Runs before main, since Ceres calls BLAS, too. True if OpenBLAS is built without
// threads: it then gives concurrent callers the same work space (0.3.21 looks for a free one
// outside its lock), so their results are wrong.
const bool only_one_caller = [] {
  if (auto* const set = OfOpenBlas<void(int)>("openblas_set_num_threads")) set(1);
  auto* const quit = OfOpenBlas<void()>("gotoblas_dynamic_quit");
  auto* const init = OfOpenBlas<void()>("gotoblas_dynamic_init");
  if (const char* const kernels = BetterKernels(); kernels && quit && init) {
    // Repeats the choice of kernels, as its users can request.
    setenv("OPENBLAS_CORETYPE", kernels, /*overwrite=*/1);
    quit();
    init();
    unsetenv("OPENBLAS_CORETYPE");
  }
  auto* const parallel = OfOpenBlas<int()>("openblas_get_parallel");
  return parallel != nullptr && parallel() == 0;
}();

// Work space of one caller on 64-bit processors. It is mapped when first needed, and kept.
constexpr size_t kWorkSpace = size_t{128} << 20;

bool CanMap(size_t size) {
  void* const there =
      mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (there == MAP_FAILED) return false;
  munmap(there, size);
  return true;
}

// Without memory for another work space, OpenBLAS retries forever. So all work spaces, one per
// processor, are mapped before its first call, and no more callers may be active at a time. Returns
// their number; 0 if memory is short for even one. Ample memory is left for other uses.
int MapWorkSpaces() {
  if (only_one_caller) return 1;
  auto* const take = OfOpenBlas<void*(int)>("blas_memory_alloc");
  auto* const give_back = OfOpenBlas<void(void*)>("blas_memory_free");
  if (take == nullptr || give_back == nullptr) return std::numeric_limits<int>::max();
  const size_t most = std::clamp(std::thread::hardware_concurrency(), 1U, 64U);
  std::vector<void*> spaces;
  while (spaces.size() < most && CanMap((spaces.empty() ? 1 : 8) * kWorkSpace)) {
    spaces.push_back(take(0));
  }
  for (void* const space : spaces) give_back(space);
  return static_cast<int>(spaces.size());
}

class WorkSpaces {
 public:
  void Take() {
    std::unique_lock lock(mutex_);
    if (there_ == 0) there_ = MapWorkSpaces();
    if (there_ == 0) {
      throw Error(ErrorKind::kLimit, "out of memory: OpenBLAS needs " +
                                         std::to_string(kWorkSpace >> 20) +
                                         " MiB of address space; allow more (ulimit -v)")
          .About("memory");
    }
    returned_.wait(lock, [this] { return taken_ < there_; });
    ++taken_;
  }
  void Return() {
    {
      const std::lock_guard lock(mutex_);
      --taken_;
    }
    returned_.notify_one();
  }

 private:
  std::mutex mutex_;
  std::condition_variable returned_;
  int there_ = 0, taken_ = 0;
};

WorkSpaces& Spaces() {
  static WorkSpaces spaces;
  return spaces;
}

}  // namespace

BlasCall::BlasCall() { Spaces().Take(); }

BlasCall::~BlasCall() { Spaces().Return(); }

}  // namespace trilobe
