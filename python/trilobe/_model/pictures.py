"""Models and fits in notebooks: HTML with pictures, where matplotlib is installed."""

from __future__ import annotations

import base64
import html
import importlib
import io
from collections.abc import Callable, Mapping
from typing import Any

from trilobe._model.error import Error

Drawing = tuple[float, float, Callable[[Any], Any]]
"""Width and height [inches], and what draws into a figure of that size; it is left out if that raises Error."""


def plots() -> Any:
    """`trilobe.plot`, which knows all that it draws: loaded when it is first needed, as the package does it."""
    return importlib.import_module("trilobe.plot")


def page(title: str, rows: Mapping[str, str], drawings: Mapping[str, Drawing]) -> str:
    """A piece of HTML: a title, a table of names and values, and pictures by what they show."""
    parts = [f"<p><b>{html.escape(title)}</b></p>"]
    if rows:
        cells = (f"<tr><th>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>" for name, value in rows.items())
        parts.append(f"<table>{''.join(cells)}</table>")
    for name, drawing in drawings.items():
        content = _png(*drawing)
        if content is not None:
            parts.append(f'<img alt="{html.escape(name)}" src="data:image/png;base64,{content}">')
    return f"<div>{''.join(parts)}</div>"


def _png(width: float, height: float, draw: Callable[[Any], Any]) -> str | None:
    """A picture in base64, by a figure that pyplot does not know, lest a notebook shows it twice."""
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError:
        return None
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    try:
        draw(figure)
    except Error:
        return None
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=80)
    return base64.b64encode(file.getvalue()).decode("ascii")
