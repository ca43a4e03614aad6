#!/usr/bin/env bash
# Builds trilobe::evaluate alone, as where the packages of the rest are absent, uses it as another
# project would, checks that it needs nothing but the standard library, and prints how large it and
# the full library are: scripts/check_evaluate_only.sh BUILD_DIR. Needs the release preset to have
# been built.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
build_dir=$(realpath -m "${1:?usage: scripts/check_evaluate_only.sh BUILD_DIR}")
consumer=$build_dir/consumer

cmake -S . -B "$build_dir" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTRILOBE_BUILD_LIBRARY=OFF
cmake --build "$build_dir"
rm -rf "$consumer"
cmake --install "$build_dir" --prefix "$consumer/prefix"
cmake -S tests/evaluate_only -B "$consumer/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$consumer/prefix" -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
cmake --build "$consumer/build"

# d + s / (cos theta_i cos theta_o) with cosines of 0.8 and 1.
diff <("$consumer/build/consumer" tests/evaluate_only/model.json) <(echo "0.725 0.825 0.925")

# Headers of other projects must not be read either, which would leave no trace in the program.
if others=$(ninja -C "$build_dir" -t deps | grep -E '/(nlohmann|eigen3|glog|gflags|gsl|ceres|stb)/'); then
  echo "the library that only evaluates reads headers of other projects: $others" >&2
  exit 1
fi

# The program may load only libraries that come with every C++ compiler.
needed=$(readelf --dynamic "$consumer/build/consumer" | grep -oP '\(NEEDED\).*\[\K[^]]+')
if others=$(grep -vE '^(libstdc\+\+|libm|libgcc_s|libc|ld-linux[^.]*)\.so' <<<"$needed"); then
  echo "the library that only evaluates needs more than the standard library: $others" >&2
  exit 1
fi

kilobytes() { size --totals "$1" | awk 'END { printf "%.0f kB", $4 / 1000 }'; }
echo "code and data of libtrilobe_evaluate.a: $(kilobytes "$build_dir/src/libtrilobe_evaluate.a");" \
  "libtrilobe.a: $(kilobytes build/release/src/libtrilobe.a)"
printf '%s\n' core/{base,files} model | while read -r room; do
  # A room without public headers, say, lacks some of these.
  { cat "src/$room"/*.cc "src/$room"/*.h "include/trilobe/$room"/*.h 2>/dev/null || true; } |
    awk -v room="$room" '!/^ *(\/\/|$)/ { ++lines } END { print "lines of", room ", without comments:", lines }'
done | awk '{ sum += $NF; print } END { print "in all:", sum }'
