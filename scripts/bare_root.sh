# Shared by the checks of wheels and archives: roots in which there is hardly anything, to run in what others are to run.
# To be sourced by bash, after setup.sh; needs root.
# shellcheck shell=bash

# make_bare_root ROOT PROGRAM...: this machine's own files of bash, env, ls and these programs, with the libraries that
# they load, all of glibc, and of C++ those that a manylinux wheel takes from the system.
make_bare_root() {
  local root=$1 link
  shift
  # Debian's lib is a link to usr/lib, and so on.
  for link in /bin /sbin /lib /lib64; do [[ ! -L $link ]] || cp --no-dereference "$link" "$root"; done
  mkdir -p "$root"/{usr/{bin,sbin,lib,lib64},dev,proc,tmp}
  cp -a /dev/null /dev/urandom "$root/dev"
  copy_into "$root" /usr/bin/{bash,env,ls} "$@" /etc/ld.so.conf /etc/ld.so.conf.d
  local libc cxx libraries
  libc=$(ldconfig -p | awk '$1 == "libc.so.6" && !n++ { print $NF }')
  cxx=$(ldconfig -p | awk '$1 == "libstdc++.so.6" && !n++ { print $NF }')
  mapfile -t libraries < <({
    printf '%s\n' "${libc%/*}"/lib{c,m,mvec,pthread,dl,rt,util}.so.* "$cxx"
    ldd /usr/bin/{bash,env,ls} "$@" "$cxx" | grep -oP '/\S+\.so\S*(?= \()'
  } | sort -u)
  copy_into "$root" "${libraries[@]}"
  ldconfig -r "$root"
}

# copy_into ROOT FILE...: to the same path below the root.
copy_into() { cp --recursive --parents --dereference --target-directory="$1" "${@:2}"; }

# expect_bare ROOT: ends where it has a compiler, or a library that the program needs.
expect_bare() {
  local unneeded
  unneeded=$(find "$1" -regextype posix-extended -regex \
    '.*/(lib(gsl|ceres|glog|gflags|blas|lapack|openblas|cholmod|pugixml|gfortran|gomp)[^/]*|(gcc|g\+\+|cc1|cc|ld|clang|cmake)[-0-9.]*)')
  [[ -z $unneeded ]] || die "the bare root is not bare: $unneeded"
  echo "The root has $(du -sm "$1" | cut -f1) MB, and no compiler, GSL, Ceres Solver, glog, gflags or BLAS."
}

# within ROOT COMMAND...: runs it there, with a /proc, by which programs find what lies beside them.
within() { unshare --mount --pid --fork --root="$1" --mount-proc /usr/bin/env -i HOME=/tmp PATH=/usr/bin "${@:2}"; }

# without COMMAND...: runs it here without an environment, as within does: some of OpenBLAS' variables choose its kernels.
without() { env -i HOME=/tmp PATH=/usr/bin "$@"; }

# untimed FOLDER: the model of a fit there, without what each run has of its own.
untimed() { grep -vE '"(seconds|date|run)":' "$1/model.json"; }
