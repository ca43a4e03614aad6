"""What all of the package raises for bad input."""

from __future__ import annotations


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
