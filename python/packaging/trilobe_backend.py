"""Builds the package trilobe: scikit-build-core, but that a checkout says where trilobe-evaluate is.

trilobe needs trilobe-evaluate of its own version. pip asks for that before it builds, and would look for it on PyPI
while the checkout holds it: so the answer is the folder. A wheel may be installed elsewhere, and names the version.
"""

import re
from pathlib import Path

from scikit_build_core import build as backend
from scikit_build_core.build import *  # noqa: F403

# Not resolved: pip takes a folder by two paths for two packages.
ROOT = Path(__file__).parents[2]


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes what pip wants to know before it builds."""
    return _point(metadata_directory, backend.prepare_metadata_for_build_wheel(metadata_directory, config_settings))


def prepare_metadata_for_build_editable(metadata_directory, config_settings=None):
    """Writes the same before an editable package."""
    return _point(metadata_directory, backend.prepare_metadata_for_build_editable(metadata_directory, config_settings))


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Makes the wheel, without the metadata, as scikit-build-core refuses others than its own."""
    return backend.build_wheel(wheel_directory, config_settings)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    """Makes the wheel of an editable package."""
    return backend.build_editable(wheel_directory, config_settings)


def _point(metadata_directory, name):
    # A source distribution has a PKG-INFO, and PyPI lets no package of its own point elsewhere.
    if not (ROOT / "PKG-INFO").exists():
        metadata = Path(metadata_directory, name, "METADATA")
        pointed, count = re.subn(
            r"(?m)^(Requires-Dist: trilobe-evaluate) *==.*$",
            lambda match: f"{match[1]} @ {(ROOT / 'python/evaluate').as_uri()}",
            metadata.read_text(encoding="utf-8"),
        )
        if count != 1:
            raise RuntimeError(f"trilobe needs {count} versions of trilobe-evaluate, not one")
        metadata.write_text(pointed, encoding="utf-8")
    return name
