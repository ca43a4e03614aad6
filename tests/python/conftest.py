"""Skips what needs the package where it has not been built; what tests share."""

import pytest

trilobe = pytest.importorskip("trilobe")

from models import SMALL  # noqa: E402


@pytest.fixture(scope="module")
def plastic():
    """A measurement."""
    return trilobe.read(SMALL, noise=0.02)
