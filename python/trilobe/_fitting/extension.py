"""The extension module that fits, which a package that only evaluates lacks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from trilobe import _core
from trilobe._model.error import Error


def fits() -> Any:
    """The module that fits; an Error that says why not, where there is none."""
    try:
        from trilobe import _fit
    except ImportError as error:
        here = Path(_core.__file__).parent
        if any(here.glob("_fit.*.so")):
            raise Error(
                f"what fits cannot be loaded ({error}); install the packages of the group run in dependencies.txt"
            ) from None
        raise Error(
            "this package only evaluates models; pip install trilobe adds what reads and fits measurements"
        ) from None
    return _fit
