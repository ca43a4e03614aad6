#!/usr/bin/env bash
# Installs wheels where there is nothing but Python, bash and coreutils: a root made of this machine's own files of
# these. There it times pip and the import, fits, evaluates, and takes what fits away again.
#   scripts/check_wheels.sh PYTHON FOLDER      FOLDER is that of scripts/wheels.sh; needs root, and PyPI
# The limits are of processor time, as others may use the machine: 20 s for pip, 0.2 s for the import.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh
source scripts/bare_root.sh
python=$(realpath "$1") folder=$2
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

mapfile -t standard_library < <("$python" -c 'import sysconfig
print(sysconfig.get_path("stdlib"), getattr(__import__("ensurepip"), "_WHEEL_PKG_DIR", None) or "", sep="\n")')
mkdir -p "$root/wheels"
for place in "${standard_library[@]}"; do
  [[ -z $place ]] || tar -C / --exclude={dist-packages,site-packages,test,'config-*'} -c "${place#/}" | tar -C "$root" -x
done
make_bare_root "$root" "$python" "${standard_library[0]}"/lib-dynload/*.so

"$python" -m pip download --quiet --disable-pip-version-check --only-binary=:all: --dest="$root/wheels" 'numpy>=1.22'
cp "$folder"/*.whl "$root/wheels"
expect_bare "$root"

bare() { within "$root" "$@"; }

at_most() { awk -v is="$1" -v limit="$2" 'BEGIN { exit !(is <= limit) }' || die "$3 took $1 s, more than $2 s"; }

# install NAME PACKAGE: into an environment of that name.
install() {
  local TIMEFORMAT='%R %U %S' elapsed user system
  bare "$python" -m venv "/$1"
  { time bare "/$1/bin/pip" install --quiet --disable-pip-version-check --no-index --find-links=/wheels "$2"; } 2>"$root/time"
  read -r elapsed user system < <(tail -n 1 "$root/time")
  echo "pip install $2: $elapsed s, $user s + $system s of processor time"
  at_most "$(awk '{ print $1 + $2 }' <<<"$user $system")" 20 "pip install $2"
  bare "/$1/bin/pip" show "$2" | grep -E '^(Name|License):'
}

cat >"$root/import.py" <<'END'
import resource, subprocess, sys

def seconds(statement):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", statement], check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

python, numpy, trilobe = (min(seconds(s) for _ in range(20)) for s in ("", "import numpy", "import trilobe"))
print(f"{trilobe - python:.3f} s, of which numpy {numpy - python:.3f} s")
END
cat >"$root/evaluate.py" <<'END'
import trilobe

print("trilobe.load:", trilobe.load("material:linen").eval([0, 0, 1], [0, 0.6, 0.8]))
try:
    trilobe.solvers()
except trilobe.Error as error:
    print("trilobe.solvers:", error)
END
awk '/^```/ { inside = ($0 == "```python"); next } inside' README.md >"$root/example.py"

install evaluates trilobe-evaluate
bare /evaluates/bin/python /evaluate.py | tee "$root/said"
grep -q "pip install trilobe adds" "$root/said"

install all trilobe
imported=$(bare /all/bin/python /import.py)
echo "import trilobe: $imported"
at_most "${imported%% *}" 0.2 "import trilobe"
bare /all/bin/python /example.py | sed "s/^/README.md's example: /"
# The wheel's program and the one that was built for it have the same fits, to the bit.
fit=(fit synth:copper@24x24x48 --noplots)
bare /all/bin/trilobe "${fit[@]}" --out=/tmp/copper 2>"$root/notes" | grep ^verdict
without "$folder/build/trilobe/bin/trilobe" "${fit[@]}" --out="$root/tmp/here" >"$root/report" 2>&1
diff <(untimed "$root/tmp/copper") <(untimed "$root/tmp/here")
bare /all/bin/pip uninstall --quiet --yes trilobe
bare /all/bin/python /evaluate.py | cmp - "$root/said"
echo "Without trilobe, trilobe-evaluate goes on."
