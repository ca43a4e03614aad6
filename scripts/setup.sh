# Shared by ./run, ./check and .ci/run: installs Debian packages and builds presets.
# To be sourced by bash, with the repository's root as the current directory.
# shellcheck shell=bash

log_dir=build/log

# step WHAT: says what comes next, and how long the script that was called first has run [min:s].
export TRILOBE_STARTED=${TRILOBE_STARTED-$EPOCHSECONDS}
step() {
  local seconds=$((EPOCHSECONDS - TRILOBE_STARTED))
  printf '==> [%d:%02d] %s\n' $((seconds / 60)) $((seconds % 60)) "$*"
}

die() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# begin_setup, end_setup: one script at a time does what is between them in this folder, and others wait for it. Commands
# inherit the lock, so that nobody builds beside a build whose script was killed. end_setup takes it from all that have
# it, so that a daemon that one of them started does not keep it.
begin_setup() {
  command -v flock >/dev/null || return 0
  mkdir -p build
  exec {setup_lock}>build/setup.lock
  trap end_setup EXIT
  local status=0
  flock --nonblock "$setup_lock" || status=$?
  ((status == 1)) || return 0 # it is had, or the file system knows no locks
  step "Waiting for another ./run or ./check, which sets up this folder"
  flock "$setup_lock"
}

end_setup() {
  [[ -n ${setup_lock-} ]] || return 0
  flock --unlock "$setup_lock" || true
  exec {setup_lock}>&-
  setup_lock=''
}

# quietly NAME COMMAND...: runs COMMAND with its output in build/log/NAME.log, and shows the end of
# that file only if COMMAND fails.
quietly() {
  local log=$log_dir/$1.log
  shift
  mkdir -p "$log_dir"
  if ! "$@" >"$log" 2>&1 </dev/null; then
    tail -n 60 "$log" >&2
    local command=$*
    die "'${command#tell_progress }' failed; all of its output is in $log"
  fi
}

# slowly NAME COMMAND...: the same for a build, and says now and then how far ninja has come.
progress_seconds=30
slowly() {
  local name=$1
  shift
  quietly "$name" tell_progress "$@" 3>&1
}

# tell_progress COMMAND...: passes on what COMMAND says, and tells file descriptor 3 how many of ninja's
# steps ("[12/63] ...") or ctest's tests (" 12/63 Test ...") are done; and how long other steps take if they
# take as long each, which tests do not: ctest starts with the longest. What apt says of its progress alone
# ("dlstatus:2:40.5:..." of downloads, "pmstatus:cmake:30.1:..." of dpkg) is told and not passed on.
tell_progress() {
  local begin=$EPOCHSECONDS told=$EPOCHSECONDS line='' part status made all kind='' far='' to_go
  local -A apt=([dl]=downloaded [pm]=installed)
  "$@" 2>&1 | while true; do
    IFS= read -r -t 1 part && status=0 || status=$?
    line+=$part
    if ((status <= 128)); then # not for want of time: a line, or the end
      ((status == 0)) || [[ -n $line ]] || break
      if [[ $line =~ ^(dl|pm)status:[^:]*:([0-9]+) ]]; then
        far="${BASH_REMATCH[2]} % ${apt[${BASH_REMATCH[1]}]}"
      else
        printf '%s\n' "$line"
        if [[ $line =~ ^\ *\[?([0-9]+)/([0-9]+)(\]|\ Test\ ) ]] && ((BASH_REMATCH[1] > 0)); then
          made=${BASH_REMATCH[1]} all=${BASH_REMATCH[2]} kind=${BASH_REMATCH[3]}
          far="$made of $all done"
        fi
      fi
      line=''
    fi
    if [[ -n $far ]] && ((EPOCHSECONDS - told >= progress_seconds)); then
      told=$EPOCHSECONDS
      to_go=''
      if [[ $kind == ']' ]]; then
        to_go="; at this pace $(duration $(((all - made) * (told - begin) / made))) to go"
      fi
      step "$far$to_go" >&3
    fi
  done
}

# duration SECONDS
duration() {
  if (($1 < 90)); then echo "$1 s"; else echo "$((($1 + 30) / 60)) min"; fi
}

# Packages of the groups given, one a line.
packages_of() {
  local group
  for group in "$@"; do
    awk -v group="$group" '$1 == group { print $2 }' dependencies.txt
  done
}

is_installed() {
  [[ $(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

# A dpkg that was killed while it worked wants to finish that before anything else, and package lists
# may be absent or too old to match what the mirror has: both are set right only when it fails.
apt_install() {
  local install=(apt-get install -y --no-install-recommends -o DPkg::Lock::Timeout=300 -o APT::Status-Fd=1 "$@")
  "${as_root[@]}" "${install[@]}" && return
  "${as_root[@]}" dpkg --configure -a || true
  "${as_root[@]}" apt-get update && "${as_root[@]}" "${install[@]}"
}

# setup_packages GROUP...: installs what is missing of these groups. From then on what was compiled before
# from the same text, in this checkout or another, comes from ccache where that is installed.
setup_packages() {
  install_packages "$@"
  if command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER=$PWD/scripts/cached_compiler.sh
  fi
}

install_packages() {
  local package packages missing=()
  mapfile -t packages < <(packages_of "$@")
  if ! command -v apt-get dpkg-query >/dev/null; then
    step "No apt-get here: assuming that you have installed what dependencies.txt lists"
    return
  fi
  for package in "${packages[@]}"; do
    is_installed "$package" || missing+=("$package")
  done
  ((${#missing[@]} == 0)) && return

  as_root=(env DEBIAN_FRONTEND=noninteractive)
  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null || { [[ ! -t 0 ]] && ! sudo -n true 2>/dev/null; }; then
      die "packages are missing, and installing them needs root. As root, run:
  apt-get update && apt-get install --no-install-recommends ${missing[*]}"
    fi
    sudo true # asks for the password here, where it can be seen
    as_root=(sudo env DEBIAN_FRONTEND=noninteractive)
  fi
  step "Installing Debian packages: ${missing[*]}"
  progress_seconds=5 slowly apt apt_install "${missing[@]}"
}

# configure PRESET [ARGUMENT...]: configures its folder.
configure() {
  quietly "configure-$1" cmake --preset "$@"
}

# build PRESET [TARGET...]: builds a configured preset, with ninja's progress line on a terminal, and
# a line now and then where there is none.
build() {
  set_build_command "$@"
  if [[ -t 1 ]]; then
    "${build_command[@]}" || die "the build failed"
  else
    slowly "build-$1" "${build_command[@]}"
  fi
}

# rebuild PRESET [TARGET...]: the same where there may be nothing to do; then it says nothing.
rebuild() {
  set_build_command "$@"
  slowly "build-$1" "${build_command[@]}"
}

set_build_command() {
  build_command=(cmake --build --preset "$1" --parallel "$(nproc)")
  shift
  (($# == 0)) || build_command+=(--target "$@")
}

# work MINUTES: how long a build takes; the fewer minutes are of a core of 2023.
work() {
  echo "some $1 minutes of one core's time, shared by $(nproc); less where ccache knows a part"
}

# run_tests PRESET: runs its tests and shows how ctest closes; on failure, what failed and why.
run_tests() {
  local log=$log_dir/test-$1.log
  mkdir -p "$log_dir"
  if ! tell_progress ctest --preset "$1" --parallel "$(nproc)" --no-tests=error 3>&1 >"$log" 2>&1 </dev/null; then
    grep -vE '^ *[0-9]+/[0-9]+ Test .* Passed |^ *Start +[0-9]+:' "$log" >&2
    die "tests failed; all of their output is in $log"
  fi
  sed -n '/tests passed/,$p' "$log"
}
