#ifndef TRILOBE_CORE_BASE_MULTIVERSION_H_
#define TRILOBE_CORE_BASE_MULTIVERSION_H_

// TRILOBE_MULTIVERSION, before a function with a hot loop, compiles one copy for each vector width
// of x86-64 and selects one at program start, so that one binary is fast on any machine. All copies
// give the same bits: no loop is reassociated (sums keep 8 lanes at any width) and no multiply-add
// is fused (-ffp-contract=off).
//
// There is a single copy under sanitizers, which instrument the selection although it runs before
// they are initialised, and under clang, whose support is recent. TRILOBE_WIDEST_VECTOR (CMake)
// leaves out wide copies, to test what older processors run.
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

// For functions called by multiversioned ones: they must be inlined into each copy.
#define TRILOBE_ALWAYS_INLINE [[gnu::always_inline]] inline

namespace trilobe {

// Vectors of doubles, compiled to the registers available.
using Lanes4 = double __attribute__((vector_size(4 * sizeof(double))));
// For AVX-512 only: without 512-bit registers gcc keeps it in memory, up to twelve times slower.
using Lanes8 = double __attribute__((vector_size(8 * sizeof(double))));

// Eight lanes in two vectors of four. Kernels on eight lanes are templates of Lanes8 or TwoLanes4
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
// Concatenates two vectors of four.
TRILOBE_ALWAYS_INLINE void Join(const Lanes4& low, const Lanes4& high, Lanes8* joined) {
  *joined = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
TRILOBE_ALWAYS_INLINE void Join(const Lanes4& low, const Lanes4& high, TwoLanes4* joined) {
  *joined = {low, high};
}

// Like TRILOBE_MULTIVERSION, for kernels on eight lanes: returns kernel<Lanes>(arguments), inlined
// into a copy for the widest vectors of the processor.
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

// y += a x for `size` numbers, a multiple of 4.
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
