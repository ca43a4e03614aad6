#!/usr/bin/env bash
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
  # What a first run leaves behind, killed with its dpkg.
  apt-get install >"$root/first.log" 2>&1 && die "dpkg was not killed"
  is_installed trilobe-setup-check && die "the package is installed, and nothing is left to do"
  : >"$root/calls"
  setup_packages run
  is_installed trilobe-setup-check || die "the package is still not installed"
)
grep -q 'apt-get install' "$root/calls"
