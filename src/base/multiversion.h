#ifndef TRILOBE_BASE_MULTIVERSION_H_
#define TRILOBE_BASE_MULTIVERSION_H_

// Before a function with a hot loop: compiles one copy for each vector width of x86-64, and picks
// one when the program starts, so that one binary runs on any machine at its best. The copies give
// the same bits, since no loop reassociates (sums keep 8 lanes whatever the width) and no
// multiply-add is fused (-ffp-contract=off).
//
// Sanitizers instrument the picking, which runs before they are ready: a single copy there. So it
// is with clang, where the attribute is young. TRILOBE_WIDEST_VECTOR (CMake) leaves wide copies
// out: what remains is what an older processor runs.
#ifndef TRILOBE_WIDEST_VECTOR
#define TRILOBE_WIDEST_VECTOR 512
#endif
#if TRILOBE_WIDEST_VECTOR >= 512
#define TRILOBE_COPIES "avx512f", "avx2", "default"
#else
#define TRILOBE_COPIES "avx2", "default"
#endif
#if TRILOBE_WIDEST_VECTOR >= 256 && defined(__x86_64__) && defined(__GNUC__) && \
    !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TRILOBE_MULTIVERSION __attribute__((target_clones(TRILOBE_COPIES)))
#else
#define TRILOBE_MULTIVERSION
#endif

#include <cstring>

// For what such functions call: it must become part of each copy.
#define TRILOBE_ALWAYS_INLINE [[gnu::always_inline]] inline

namespace trilobe {

// Vectors of doubles that compile to whatever registers there are.
using Lanes4 = double __attribute__((vector_size(4 * sizeof(double))));
using Lanes8 = double __attribute__((vector_size(8 * sizeof(double))));

template <typename Lanes>
TRILOBE_ALWAYS_INLINE void LoadLanes(const double* from, Lanes* target) {
  std::memcpy(target, from, sizeof(Lanes));
}
template <typename Lanes>
TRILOBE_ALWAYS_INLINE void StoreLanes(const Lanes& from, double* target) {
  std::memcpy(target, &from, sizeof(Lanes));
}
// y += a x, for `size` numbers in whole vectors of four.
TRILOBE_ALWAYS_INLINE void AddScaled(int size, double a, const double* x, double* y) {
  for (int k = 0; k < size; k += 4) {
    Lanes4 x_k, y_k;
    LoadLanes(x + k, &x_k);
    LoadLanes(y + k, &y_k);
    StoreLanes(y_k + a * x_k, y + k);
  }
}

}  // namespace trilobe

#endif  // TRILOBE_BASE_MULTIVERSION_H_
