#!/usr/bin/env bash
# Compiles through ccache, so that what another checkout has compiled is found as well:
# scripts/cached_compiler.sh COMPILER ARGUMENT..., which setup.sh makes CMake's compiler launcher.
set -euo pipefail

# A build folder that was made with ccache goes on without, and so it does where a home cannot be
# written to: ccache itself would fail.
if ! { cache=$(ccache --get-config cache_dir) && mkdir -p "$cache" && [[ -w $cache ]]; } 2>/dev/null; then
  exec "$@"
fi

# Paths below the repository do not count, nor does the folder that the compiler runs in.
CCACHE_BASEDIR=$(dirname "$(dirname "$(realpath "${BASH_SOURCE[0]}")")")
export CCACHE_BASEDIR CCACHE_NOHASHDIR=1
# ccache requires these where headers are precompiled.
export CCACHE_PCH_EXTSUM=1 CCACHE_SLOPPINESS=pch_defines,time_macros

# ccache makes paths relative but for this one, of clang's precompiled headers:
# -Xclang -include -Xclang PATH.
arguments=()
for argument in "$@"; do
  if [[ ${arguments[*]: -3} == "-Xclang -include -Xclang" ]]; then
    argument=$(realpath --relative-to=. "$argument")
  fi
  arguments+=("$argument")
done
[[ " $* " == *" -x c++-header "* ]] || exec ccache "${arguments[@]}"

# To precompile headers. ccache would not see that a macro of theirs has changed, and what clang makes
# names the folder that it was made in, so no other checkout makes the same bytes. They are made each
# time, and in place of the bytes of FILE ccache looks at FILE.sum (CCACHE_PCH_EXTSUM): here, of all text
# that is precompiled, macros included. (Lines are not counted: what a debugger says of these headers may
# be off by some.)
"${arguments[@]}"
preprocess=() file=
for ((i = 0; i < ${#arguments[@]}; ++i)); do
  case ${arguments[i]} in
    -o) file=${arguments[++i]} ;;
    -MF | -MT) ((++i)) ;;
    -MD | -c) ;;
    -Xclang) [[ ${arguments[i + 1]} == -emit-pch ]] && ((++i)) || preprocess+=(-Xclang) ;;
    *) preprocess+=("${arguments[i]}") ;;
  esac
done
"${preprocess[@]}" -E -P -dD | sha256sum >"$file.sum"
