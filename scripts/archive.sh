#!/usr/bin/env bash
# Packs the program, with the shared libraries that it needs, into build/archive/trilobe-VERSION-linux-MACHINE.tar.gz,
# which runs where it is unpacked, without a compiler and without Debian's packages (gnuplot draws its pictures):
#   scripts/archive.sh [--check]
# --check unpacks it in a bare root, fits there, and compares the model with that of the program as it was built.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh
source scripts/bare_root.sh
setup_packages run archive

step "Building the program: $(work "3 to 6")"
configure release
build release trilobe_app

folder=$PWD/build/archive
program=build/release/bin/trilobe
version=$("$program" --version | awk '{ print $NF }')
name=trilobe-$version-linux-$(uname -m)
staged=$folder/$name
rm -rf "$staged" "$staged.tar.gz"
mkdir -p "$staged"/{bin,lib/trilobe,licences,share/man/man1,share/bash-completion/completions}

step "Packing it with its libraries"
strip -o "$staged/bin/trilobe" "$program"
# Of all libraries those are left to the system that come with glibc.
mapfile -t libraries < <(ldd "$program" | awk '$3 ~ /^\// { print $3 }' |
  grep -vE '/(ld-linux[^/]*|lib(c|m|mvec|pthread|dl|rt|util|resolv))\.so')
for library in "${libraries[@]}"; do cp --dereference "$library" "$staged/lib/trilobe"; done
# RPATH, which holds for libraries that libraries need, too; RUNPATH does not.
patchelf --force-rpath --set-rpath "\$ORIGIN/../lib/trilobe" "$staged/bin/trilobe"
cp scripts/trilobe.bash "$staged/share/bash-completion/completions/trilobe"
"$program" help --man >"$staged/share/man/man1/trilobe.1"
cp LICENSE "$staged"
cat >"$staged/README" <<END
trilobe $version for Linux on $(uname -m), with glibc $(objdump -T "$staged/bin/trilobe" "$staged"/lib/trilobe/* |
  grep -oP 'GLIBC_\K2\.[0-9]+' | sort -Vu | tail -n 1) or newer.

  bin/trilobe help

Pictures are drawn by gnuplot, if it is installed; all else is here. licences has those of the libraries.
END

# The licences of the libraries, and of the packages of which headers or static libraries are compiled in.
{
  for library in "${libraries[@]}"; do
    path=$(realpath "$library")
    dpkg-query --search "*${path#/usr}" | cut -d: -f1 | head -n 1
  done
  printf '%s\n' libceres-dev libeigen3-dev nlohmann-json3-dev libxxhash-dev libstb-dev
} | sort -u >"$folder/packages"
while IFS= read -r package; do
  cp "/usr/share/doc/$package/copyright" "$staged/licences/$package"
  dpkg-query --show --showformat='${Package} ${Version}\n' "$package"
done <"$folder/packages" >"$staged/licences/CONTENTS"
grep -ohP '/usr/share/common-licenses/\K[\w.-]*\w' -r "$staged/licences" | sort -u | while IFS= read -r common; do
  cp --dereference "/usr/share/common-licenses/$common" "$staged/licences/"
done

# The same bytes for the same files.
tar -C "$folder" --sort=name --owner=0 --group=0 --numeric-owner --mtime="@$(git log -1 --format=%ct)" -c "$name" |
  gzip -9n >"$staged.tar.gz"
echo "$staged.tar.gz: $(du -m "$staged.tar.gz" | cut -f1) MB, $(du -sm "$staged" | cut -f1) MB when unpacked"

[[ ${1-} == --check ]] || exit 0
step "Unpacking it where there is neither a compiler nor any library of its"
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
make_bare_root "$root"
expect_bare "$root"
mkdir -p "$root/anywhere at all"
tar -C "$root/anywhere at all" -xzf "$staged.tar.gz"
unpacked="/anywhere at all/$name/bin/trilobe"
fit=(fit synth:copper@24x24x48 --noplots)
within "$root" "$unpacked" --version
within "$root" "$unpacked" "${fit[@]}" --out=/tmp/copper 2>"$root/notes" | grep ^verdict
without "$program" "${fit[@]}" --out="$root/tmp/here" >"$root/report" 2>&1
diff <(untimed "$root/tmp/copper") <(untimed "$root/tmp/here")
echo "It has the models of the program as it was built, to the bit."
