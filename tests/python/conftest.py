"""Skips what needs the package where it has not been built."""

import pytest

pytest.importorskip("trilobe")
