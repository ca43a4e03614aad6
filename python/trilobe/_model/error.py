"""What all of the package raises for bad input."""

from __future__ import annotations

import re

# A flag with its value, which may stand in quotes as a shell needs them. At the beginning of a message the value ends
# at ": ", as it may have blanks.
_BEGINNING = re.compile(r"\A--([a-z][a-z0-9_]*)=(.*?)(?=: )")
_FLAG = re.compile(r"(['\"])--([a-z][a-z0-9_]*)=(.*?)\1|(?<![\w/.'\"-])--([a-z][a-z0-9_]*)(?:=([^\s;)]*[^\s;),.:]))?")
# A command that a message advises, and the call that does the same.
_COMMAND, _CALL = re.compile(r"trilobe measure --directions=(\d+)"), r"trilobe.directions_to_measure(\1)"
_OTHER_NAMES = {"data_seed": "seed"}
_SWITCHES = ("dark_noise", "diagnose", "extrapolated", "match_reflectance", "outliers", "raw", "spectral")


class Error(ValueError):
    """Bad input or an impossible request. Its text is one line: what is wrong, where, what to do.

    Programs go by its attributes, since sentences may be bettered. Each is None where it is not known.

    Attributes:
        kind: "format", "range", "unknown", "conflict", "mismatch", "missing", "unsupported", "file", "data" or "limit"
            (docs/python.md).
        file: the file, or another source, as "synth:felt".
        line: the line of the file, from 1.
        key: what is wrong: the name of an option, an argument, a column, a JSON pointer.
        value: what it is, as text.
    """

    def __init__(
        self,
        message: str,
        *,
        kind: str | None = None,
        file: str | None = None,
        line: int | None = None,
        key: str | None = None,
        value: str | None = None,
    ) -> None:
        super().__init__(message)
        self.kind = kind
        self.file = file
        self.line = line
        self.key = key
        self.value = value


Error.__module__ = "trilobe"


def in_keywords(text: str) -> str:
    """A message of the program with Python's keywords in the place of flags: `lobes=` for --lobes.

    A value is written as Python has it, `model="auto"` for --model=auto; of one that is no number, in quotes.
    """

    def keyword(name: str, value: str | None) -> str:
        if value is None and name in _SWITCHES:
            return f"{name}=True"
        if value is None and name.startswith("no") and name[2:] in _SWITCHES:
            return f"{name[2:]}=False"
        name = _OTHER_NAMES.get(name, name)
        return f"{name}={'' if value is None else _as_python(value)}"

    text = _COMMAND.sub(_CALL, text)
    text = _BEGINNING.sub(lambda found: keyword(found[1], found[2]), text, count=1)
    return _FLAG.sub(lambda found: keyword(found[2] or found[4], found[3] or found[5]), text)


def _as_python(value: str) -> str:
    if value in ("true", "false"):
        return value.capitalize()
    if value.isalpha() and value.isupper():  # stands for one, as DEGREES does
        return value
    try:
        float(value)
    except ValueError:
        return '"' + value.replace('"', "'") + '"'
    return value
