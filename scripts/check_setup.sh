#!/usr/bin/env bash
# Checks scripts/setup.sh: that it goes on where a dpkg was killed, that a build is not silent
# where there is no terminal, and that two scripts do not set up one folder at the same time.
#
# Lets dpkg be killed while it configures a package, as by a lost connection, and checks that
# setup_packages still installs it. The package is made here and goes into a folder of its own, which
# dpkg takes for the root of the system; apt-get is played by a script, as it would want a mirror.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

mkdir -p "$root"/{bin,system/var/lib/dpkg/{info,updates},package/DEBIAN}
touch "$root"/system/var/lib/dpkg/{status,available}

cat >"$root/package/DEBIAN/control" <<END
Package: trilobe-setup-check
Version: 1
Architecture: all
Maintainer: nobody <nobody@example.org>
Description: dies while it is configured for the first time
END
cat >"$root/package/DEBIAN/postinst" <<END
#!/bin/sh
[ -e $root/killed ] || { touch $root/killed; kill -9 \$PPID; }
END
chmod 755 "$root/package/DEBIAN/postinst"
dpkg-deb --root-owner-group --build "$root/package" "$root/package.deb" >"$root/build.log"

for tool in dpkg dpkg-query; do
  options="--root=$root/system"
  [[ $tool == dpkg ]] && options+=" --force-script-chrootless --force-not-root --log=$root/dpkg.log"
  printf '#!/bin/sh\nexec %s %s "$@"\n' "$(command -v $tool)" "$options" >"$root/bin/$tool"
done
cat >"$root/bin/apt-get" <<END
#!/bin/sh
echo "apt-get \$1" >>$root/calls
[ "\$1" = install ] || exit 0
if [ -n "\$(dpkg --audit)" ]; then
  echo "E: dpkg was interrupted, you must manually run 'dpkg --configure -a' to correct the problem." >&2
  exit 100
fi
dpkg --install $root/package.deb
END
chmod 755 "$root"/bin/*

(
  PATH=$root/bin:$PATH
  source scripts/setup.sh
  log_dir=$root/log
  packages_of() { echo trilobe-setup-check; }
  step() { :; }
  # Nothing here needs root.
  sudo() {
    [[ $1 != -n ]] || shift
    "$@"
  }
  # A first run that is killed with its dpkg leaves this state.
  apt-get install >"$root/first.log" 2>&1 && die "dpkg was not killed"
  is_installed trilobe-setup-check && die "the package is installed, and nothing is left to do"
  : >"$root/calls"
  setup_packages run
  is_installed trilobe-setup-check || die "the package is still not installed"
)
grep -q 'apt-get install' "$root/calls"

# A build of four steps that ends after two, and a test: what is told of them now and then, and what is kept.
ninja="$root/a folder/ninja"
mkdir "${ninja%/*}"
cat >"$ninja" <<'END'
#!/bin/sh
echo "[1/4] Building one.o"
[ "$1" = 0 ] || exit "$1"
sleep 1.1
echo "one.cc: a warning" >&2
printf '[2/4] Building'
sleep 1.1
echo " two.o"
sleep 1.1
echo "  3/40 Test #7: some ....   Passed    0.90 sec"
sleep 1.1
END
chmod 755 "$ninja"
(
  source scripts/setup.sh
  log_dir="$root/a folder/log"
  progress_seconds=1
  slowly four "$ninja" 0 >"$root/told"
  # A time of builds alone, as the tests that come first take the longest.
  for told in "1 of 4 done; at this pace [0-9]* s to go" "2 of 4 done; at this pace [0-9]* s to go" "3 of 40 done"; do
    grep -q "$told\$" "$root/told" || die "$(cat "$root/told")"
  done
  diff - "$log_dir/four.log" <<'END'
[1/4] Building one.o
one.cc: a warning
[2/4] Building two.o
  3/40 Test #7: some ....   Passed    0.90 sec
END
  (slowly four "$ninja" 3) >"$root/told" 2>&1 && die "a build that fails is taken for one that does not"
  grep -qF "error: '$ninja 3' failed; all of its output is in $log_dir/four.log" "$root/told"
)

# The second script waits while the first sets up and for no longer, though the first runs on, and a daemon as well.
mkdir -p "$root/checkout/scripts"
cp scripts/setup.sh "$root/checkout/scripts"
cat >"$root/checkout/script" <<'END'
set -euo pipefail
cd "$(dirname "$0")"
source scripts/setup.sh
begin_setup
echo "$1 begins" >>order
sleep 30 &
daemon=$!
trap 'kill "$daemon"' TERM
until [[ $1 == second || -e go_on ]]; do sleep 0.05; done
echo "$1 ends" >>order
end_setup
[[ $1 == second ]] || wait "$daemon" || true
kill "$daemon" 2>/dev/null || true
END
# until_there TEXT FILE: waits for less than the daemon runs.
until_there() {
  for _ in {1..400}; do
    if grep -qs "$1" "$2"; then return; fi
    sleep 0.05
  done
  echo "no '$1' in $2" >&2
  return 1
}
bash "$root/checkout/script" first >"$root/first" &
first=$!
until_there "first begins" "$root/checkout/order"
bash "$root/checkout/script" second >"$root/second" &
second=$!
until_there "Waiting for another" "$root/second"
touch "$root/checkout/go_on"
until_there "second ends" "$root/checkout/order"
wait "$second"
kill "$first" # which still runs
wait "$first" || true
diff - "$root/checkout/order" <<'END'
first begins
first ends
second begins
second ends
END
[[ ! -s $root/first ]]
