#!/usr/bin/env python3
"""Puts the licences of what a repaired wheel contains of other projects into it, and tells what that is.

    scripts/wheel_licences.py WHEEL [PACKAGE...]

The libraries are those that auditwheel lists in the wheel; each PACKAGE is one of Debian's whose headers are compiled
in. Needs auditwheel and nanobind beside its Python.
"""

import importlib.metadata
import json
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


def version_of(package):
    """The version of an installed package of Debian."""
    query = ["dpkg-query", "--show", "--showformat=${Version}", package]
    return subprocess.run(query, check=True, capture_output=True, text=True).stdout


def bundled_packages(info, libraries):
    """Debian's packages of the libraries; auditwheel leaves out those that it does not know."""
    if not libraries:
        return []
    components = json.loads((info / "sboms" / "auditwheel.cdx.json").read_text())["components"][1:]
    if len(components) != len(libraries):
        sys.exit(f"auditwheel knows the packages of {len(components)} of {len(libraries)} libraries")
    return [component["name"] for component in components]


def main(wheel, compiled_in):
    """Writes the licences, and prints what the wheel has and its size."""
    with InWheelCtx(wheel) as context:
        context.out_wheel = wheel
        root = Path(context.path)
        (info,) = root.glob("*.dist-info")
        licences = info / "licenses"
        libraries = sorted(path.name for path in root.glob("*.libs/*"))
        packages = sorted({*bundled_packages(info, libraries), *compiled_in})
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
            (licences / name).write_text(file.read_text().partition("*/")[0])  # of code, its first comment
        contents = [f"{package} {version_of(package)}" for package in packages]
        contents.append(f"nanobind {nanobind.version}, with robin-map, of PyPI")
        (licences / "CONTENTS").write_text(HEAD + "\n".join(contents) + "\n")
        unpacked = sum(path.stat().st_size for path in root.rglob("*") if path.is_file())
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, {unpacked / 1e6:.1f} MB when installed")
    print("  libraries:", ", ".join(libraries) or "none")
    print("  of:", ", ".join(contents))


main(Path(sys.argv[1]).resolve(), sys.argv[2:])
