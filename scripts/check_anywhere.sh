#!/usr/bin/env bash
# Does what a newcomer does, where that is least convenient: in a copy of the repository that nobody but
# its owner may enter and whose path has spaces, with a home that cannot be written to, and without a
# terminal. There the program is built, docs/adding-a-solver.md is followed as it stands, and the tests of
# that solver and of scripts and files pass.
#   scripts/check_anywhere.sh
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
closed=$(mktemp -d) # mode 700
trap 'rm -rf "$closed"' EXIT
copy="$closed/a copy with spaces"
mkdir "$copy"
git ls-files -z --cached --others --exclude-standard | xargs -0 cp --parents --no-dereference --target-directory="$copy"

# ccache keeps its folder, so that earlier compilations of the same text are found.
if command -v ccache >/dev/null; then
  CCACHE_DIR=$(ccache --get-config cache_dir)
  export CCACHE_DIR
fi
export HOME=/proc/nowhere
unset XDG_CACHE_HOME
cd "$copy"

echo "-- ./run in '$copy'"
./run solvers </dev/null >"$closed/solvers" 2>"$closed/said"
grep 'Building the program: some .* minutes of one core' "$closed/said"

echo "-- docs/adding-a-solver.md"
awk '/^```cpp$/ { inside = 1; next } /^```$/ && inside { exit } inside' docs/adding-a-solver.md \
  >src/solvers/compass_search.cc
sed -i 's/^  X(Auto) .*/&\n  X(CompassSearch) \\/' src/solvers/starts/solvers.cc
./run solvers </dev/null | grep compass_search
./run fit synth:plastic@15x15x30 --solver=compass_search --max_iterations=2 --lobes=1 --nodiagnose \
  --out=out/found </dev/null >"$closed/report"
grep '"solver": "compass_search"' out/found/report.json

echo "-- Its tests"
source scripts/setup.sh
setup_packages run check
configure release -DTRILOBE_BUILD_TESTS=ON -DTRILOBE_BUILD_BENCHMARKS=OFF
build release solvers_tests trilobe_app
TRILOBE_TEST_LIGHTS=6 build/release/tests/solvers_tests --gtest_brief=1 \
  --gtest_filter='*compass_search*:AddingASolver.*:RecordedModels.*:Solver.*'
tests/faults/harness.py --trials=3 --seed=2
