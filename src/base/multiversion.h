#ifndef TRILOBE_BASE_MULTIVERSION_H_
#define TRILOBE_BASE_MULTIVERSION_H_

// Before a function with a hot loop: compiles one copy for each vector width of x86-64, and picks
// one when the program starts, so that one binary runs on any machine at its best. The copies give
// the same bits, since no loop reassociates (sums keep 8 lanes whatever the width) and no
// multiply-add is fused (-ffp-contract=off).
//
// Sanitizers instrument the picking, which runs before they are ready: a single copy there. So it
// is with clang, where the attribute is young.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define TRILOBE_MULTIVERSION __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define TRILOBE_MULTIVERSION
#endif

namespace trilobe {

// Vectors of doubles that compile to whatever registers there are.
using Lanes4 = double __attribute__((vector_size(4 * sizeof(double))));
using Lanes8 = double __attribute__((vector_size(8 * sizeof(double))));

}  // namespace trilobe

#endif  // TRILOBE_BASE_MULTIVERSION_H_
