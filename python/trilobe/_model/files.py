"""Paths that were given, and files that are written whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from trilobe._model.error import Error


def text_of_path(path: Any) -> str:
    """A path as a str; an Error where it is none."""
    try:
        text = os.fsdecode(path)
        text.encode("utf-8")
    except TypeError:
        raise Error(f"a path must be a str or a path, not {type(path).__name__}", kind="format") from None
    except UnicodeError:
        raise Error(f"{ascii(path)} is no path that can be written in UTF-8", kind="format") from None
    if "\0" in text:
        raise Error(f"{text!r} is no path: it has a null character", kind="format", value=text)
    return text


def _path_of(path: Any) -> Path:
    return Path(text_of_path(path))


def printable(path: str | Path) -> str:
    """A path in quotes, on one line."""
    return repr(str(path).encode("utf-8", "replace").decode("utf-8"))


def make_folder(path: Path) -> None:
    """Makes a folder, and those above it, if need be."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise Error(
            f"cannot make the folder {printable(path)}: {reason}", kind="file", file=str(path), key="make", value=reason
        ) from None


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Writes a file beside its place and moves it there."""
    try:
        content = text.encode("utf-8")
    except ValueError as error:
        name = _path_of(path)
        raise Error(f"cannot write {printable(name)}: {error}", kind="format", file=str(name), key="write") from None
    write_bytes(path, content)


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """The same of bytes."""
    import tempfile  # a third of the time that the package takes to import beyond numpy

    name = _path_of(path)
    temporary = None
    try:
        with tempfile.NamedTemporaryFile(dir=name.parent, prefix=".trilobe-", delete=False) as file:
            temporary = file.name
            file.write(content)
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(temporary, 0o666 & ~umask)
        os.replace(temporary, name)
    except (OSError, ValueError) as error:
        if temporary is not None:
            Path(temporary).unlink(missing_ok=True)
        reason = getattr(error, "strerror", None) or str(error)
        if os.path.isdir(name):  # "." is reported as busy
            reason = "it is a folder; give the name of a file"
        raise Error(
            f"cannot write {printable(name)}: {reason}", kind="file", file=str(name), key="write", value=reason
        ) from None
