# Compile options that every target of this project shares, and no consumer inherits.
#
# -ffp-contract=off: a*b+c is rounded twice on every machine, so that a result does not depend on
#   whether the compiler found an FMA instruction to use.
# -fopenmp-simd: `#pragma omp simd reduction` lets one named loop reassociate its sum, where
#   -ffast-math would let all of them. No OpenMP runtime is involved.
# -fno-semantic-interposition: nobody replaces a function of a shared library, so that position-independent
#   code inlines what other code does.
# -fmacro-prefix-map: __FILE__ does not depend on where the repository lies, so that a compiler's cache
#   serves any checkout.
# -Wno-restrict: g++ 12 warns of "literal" + std::string(...) for no reason (GCC bug 105651).
# -Wno-shadow, -Wno-subobject-linkage: in a unity build names of one file shadow those of another, and
#   g++ takes the files for headers, whose classes should not hold what is in an unnamed namespace.
# -Wno-pass-failed: clang warns where a `simd` loop is not vectorised, as under sanitizers none is.
function(trilobe_compile_options target)
  target_compile_options(${target} PRIVATE -ffp-contract=off -fopenmp-simd
    -fno-semantic-interposition
    -fmacro-prefix-map=${PROJECT_SOURCE_DIR}/= -Wall -Wextra -Wshadow
    -Wconversion -Wno-sign-conversion -Wnon-virtual-dtor -Wold-style-cast)
  if(NOT TRILOBE_WIDEST_VECTOR EQUAL 512)
    target_compile_definitions(${target} PRIVATE TRILOBE_WIDEST_VECTOR=${TRILOBE_WIDEST_VECTOR})
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(CMAKE_UNITY_BUILD)
    target_compile_options(${target} PRIVATE -Wno-shadow
                           $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${target} PRIVATE -Wno-pass-failed)
  endif()
  if(TRILOBE_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()
