#include "core/algebra/triangle.h"

#include <algorithm>

#include "trilobe/core/system/parallel.h"

namespace trilobe {

// In blocks that fit into the cache, of which a row is one thread's.
void MirrorTriangle(Triangle from, size_t n, double* A, int num_threads) {
  constexpr size_t kBlock = 16;
  ParallelFor(static_cast<int>((n + kBlock - 1) / kBlock), num_threads, [&](int row) {
    const size_t k0 = row * kBlock;
    for (size_t l0 = 0; l0 <= k0; l0 += kBlock) {
      for (size_t k = k0; k < std::min(n, k0 + kBlock); ++k) {
        for (size_t l = l0; l < std::min(k, l0 + kBlock); ++l) {
          const size_t lower = k * n + l;
          const size_t upper = l * n + k;
          A[from == Triangle::kUpper ? lower : upper] = A[from == Triangle::kUpper ? upper : lower];
        }
      }
    }
  });
}

}  // namespace trilobe
