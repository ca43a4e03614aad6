#!/usr/bin/env python3
"""Puts the licences of what a repaired wheel contains of other projects into it, and tells what that is.

    scripts/wheel_licences.py WHEEL [PACKAGE...]

The libraries are those that auditwheel has put into it; each PACKAGE is one of Debian's that is compiled in. Needs
auditwheel and nanobind beside its Python.
"""

import importlib.metadata
import re
import subprocess
import sys
from pathlib import Path

from auditwheel.wheeltools import InWheelCtx

COMMON = Path("/usr/share/common-licenses")
HEAD = """\
What this wheel contains of other projects. The licence of each is the file of its name in this folder; the source of
a Debian package is that of this version at https://snapshot.debian.org.

"""


def output_of(*command):
    """The output of a command."""
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def packages_of(libraries):
    """Debian's packages of libraries, whose names auditwheel has made longer by a hash."""
    paths = {Path(path).resolve() for path in re.findall("=> (/.*)", output_of("ldconfig", "-p"))}
    path_of = {path.name: path for path in paths}
    for library in libraries:
        path = path_of[re.sub(r"-[0-9a-f]{8}(?=\.)", "", library)]
        # A package may have it below /lib, which has become a link to /usr/lib.
        yield output_of("dpkg-query", "--search", "*" + str(path).removeprefix("/usr")).partition(":")[0]


def main(wheel, compiled_in):
    """Writes the licences, and prints what the wheel has and its size."""
    with InWheelCtx(wheel) as context:
        context.out_wheel = wheel
        root = Path(context.path)
        (info,) = root.glob("*.dist-info")
        licences = info / "licenses"
        libraries = sorted(path.name for path in root.glob("*.libs/*"))
        packages = sorted({*packages_of(libraries), *compiled_in})
        common = set()
        for package in packages:
            text = Path("/usr/share/doc", package, "copyright").read_text()
            (licences / package).write_text(text)
            common.update(re.findall(rf"{COMMON}/([\w.-]*\w)", text))
        for name in common:
            (licences / name).write_text((COMMON / name).read_text())
        nanobind = importlib.metadata.distribution("nanobind")
        for name, source in (("nanobind", "LICENSE"), ("robin-map", "robin_map.h")):
            (file,) = (file for file in nanobind.files if file.name == source)
            (licences / name).write_text(file.read_text().partition("*/")[0])  # code: its first comment
        contents = [output_of("dpkg-query", "--show", "--showformat=${Package} ${Version}", name) for name in packages]
        contents.append(f"nanobind {nanobind.version}, with robin-map, of PyPI")
        (licences / "CONTENTS").write_text(HEAD + "\n".join(contents) + "\n")
        unpacked = sum(path.stat().st_size for path in root.rglob("*") if path.is_file())
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, {unpacked / 1e6:.1f} MB when installed")
    print("  libraries:", ", ".join(libraries) or "none")
    print("  of:", ", ".join(contents))


main(Path(sys.argv[1]).resolve(), sys.argv[2:])
