#ifndef TRILOBE_CORE_BASE_MULTIVERSION_H_
#define TRILOBE_CORE_BASE_MULTIVERSION_H_

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
#define TRILOBE_HAS_COPIES
#else
#define TRILOBE_MULTIVERSION
#endif

#include <cstring>

// For what such functions call: it must become part of each copy.
#define TRILOBE_ALWAYS_INLINE [[gnu::always_inline]] inline

namespace trilobe {

// Vectors of doubles that compile to whatever registers there are.
using Lanes4 = double __attribute__((vector_size(4 * sizeof(double))));
// This one is for AVX-512: where no register holds it, gcc keeps it in memory, and takes up to
// twelve times as long.
using Lanes8 = double __attribute__((vector_size(8 * sizeof(double))));

// The same for registers of four. Kernels on eight lanes are templates of the one or the other
// (TRILOBE_FOR_EIGHT).
struct TwoLanes4 {
  Lanes4 low, high;

  TRILOBE_ALWAYS_INLINE double operator[](int lane) const {
    return lane < 4 ? low[lane] : high[lane - 4];
  }
  TRILOBE_ALWAYS_INLINE TwoLanes4& operator+=(const TwoLanes4& x) {
    low += x.low;
    high += x.high;
    return *this;
  }
  TRILOBE_ALWAYS_INLINE TwoLanes4& operator-=(const TwoLanes4& x) {
    low -= x.low;
    high -= x.high;
    return *this;
  }
  TRILOBE_ALWAYS_INLINE TwoLanes4& operator*=(const TwoLanes4& x) {
    low *= x.low;
    high *= x.high;
    return *this;
  }
  TRILOBE_ALWAYS_INLINE TwoLanes4& operator*=(double x) {
    low *= x;
    high *= x;
    return *this;
  }
  TRILOBE_ALWAYS_INLINE friend TwoLanes4 operator+(TwoLanes4 x, const TwoLanes4& y) {
    return x += y;
  }
  TRILOBE_ALWAYS_INLINE friend TwoLanes4 operator-(TwoLanes4 x, const TwoLanes4& y) {
    return x -= y;
  }
  TRILOBE_ALWAYS_INLINE friend TwoLanes4 operator*(TwoLanes4 x, const TwoLanes4& y) {
    return x *= y;
  }
  TRILOBE_ALWAYS_INLINE friend TwoLanes4 operator*(double x, TwoLanes4 y) { return y *= x; }
};

template <typename Lanes>
TRILOBE_ALWAYS_INLINE void LoadLanes(const double* from, Lanes* target) {
  std::memcpy(target, from, sizeof(Lanes));
}
TRILOBE_ALWAYS_INLINE void LoadLanes(const double* from, TwoLanes4* target) {
  LoadLanes(from, &target->low);
  LoadLanes(from + 4, &target->high);
}
template <typename Lanes>
TRILOBE_ALWAYS_INLINE void StoreLanes(const Lanes& from, double* target) {
  std::memcpy(target, &from, sizeof(Lanes));
}
TRILOBE_ALWAYS_INLINE void StoreLanes(const TwoLanes4& from, double* target) {
  StoreLanes(from.low, target);
  StoreLanes(from.high, target + 4);
}
// Two vectors of four, one behind the other.
TRILOBE_ALWAYS_INLINE void Join(const Lanes4& low, const Lanes4& high, Lanes8* joined) {
  *joined = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
TRILOBE_ALWAYS_INLINE void Join(const Lanes4& low, const Lanes4& high, TwoLanes4* joined) {
  *joined = {low, high};
}

// Returns kernel<Lanes>(arguments), a function that becomes part of its callers, from a copy for
// the widest vectors that the processor has; as TRILOBE_MULTIVERSION, for kernels on eight lanes.
#ifdef TRILOBE_HAS_COPIES
#define TRILOBE_COPY_FOR(instructions, Lanes, kernel, ...)                                     \
  [&]() __attribute__((target(instructions), noinline)) { return kernel<Lanes>(__VA_ARGS__); } \
  ()
#define TRILOBE_FOR_EIGHT(kernel, ...)                                       \
  do {                                                                       \
    if (TRILOBE_WIDEST_VECTOR >= 512 && __builtin_cpu_supports("avx512f")) { \
      return TRILOBE_COPY_FOR("avx512f", Lanes8, kernel, __VA_ARGS__);       \
    }                                                                        \
    if (__builtin_cpu_supports("avx2")) {                                    \
      return TRILOBE_COPY_FOR("avx2", TwoLanes4, kernel, __VA_ARGS__);       \
    }                                                                        \
    return kernel<TwoLanes4>(__VA_ARGS__);                                   \
  } while (false)
#else
#define TRILOBE_FOR_EIGHT(kernel, ...) return kernel<TwoLanes4>(__VA_ARGS__)
#endif

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

#endif  // TRILOBE_CORE_BASE_MULTIVERSION_H_
