"""The page of `trilobe-need`: pictures by measured, full and pruned models, where they differ, and what they take."""

from __future__ import annotations

import base64
import hashlib
from html import escape
from typing import Any

_STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; margin: 2em auto; max-width: 72em; padding: 0 1em; color: #222;
  background: #fff }
table { border-collapse: collapse; margin: 1em 0 } td, th { padding: .25em .8em; text-align: right }
th { border-bottom: 1px solid #999 } td:first-child, th:first-child { text-align: left }
figure { margin: 0 } .row { display: grid; grid-template-columns: repeat(auto-fit, minmax(14em, 1fr)); gap: 1em }
img { width: 100%; image-rendering: auto } figcaption { font-size: 13px }
@media (prefers-color-scheme: dark) { body { color: #ddd; background: #181818 } }
"""
_TITLES = {"measured": "as given", "full": "full models", "pruned": "pruned models"}


def totals(rows: list[dict[str, Any]], render_seconds: dict[str, float]) -> dict[str, Any]:
    """Totals over all materials; those that are never read have no samples."""
    samples = [row["samples"] for row in rows if "samples" in row]
    kinds = ("full", "pruned")
    parameters = {kind: sum(row["parameters"][kind] for row in rows) for kind in kinds}
    return {
        "parameters": parameters,
        "bytes": {kind: 8 * parameters[kind] for kind in kinds},
        "samples": {kind: sum(counts[kind] for counts in samples) for kind in ("valid", "used")},
        "fit_seconds": {kind: sum(row["seconds"][kind] for row in rows) for kind in kinds},
        "render_seconds": {kind: render_seconds.get(kind, 0.0) for kind in kinds},
    }


def left_text(totals: dict[str, Any]) -> str:
    """A sentence on the parameters that are left, the share of data used, and the time it took."""
    parameters, samples, fitted, rendered = (
        totals[key] for key in ("parameters", "samples", "fit_seconds", "render_seconds"))
    share = 100 * samples["used"] / max(samples["valid"], 1)
    return (
        f"{parameters['pruned']} of {parameters['full']} parameters are left, {totals['bytes']['pruned']} bytes, of "
        f"{share:.0f} % of the data; fitted in {fitted['full']:.1f} s, pruned in {fitted['pruned']:.1f} s; rendered in "
        f"{rendered['full']:.1f} s by full models, in {rendered['pruned']:.1f} s by pruned ones")


def _figure(image: str, caption: str) -> str:
    return f'<figure><img src="{image}" alt="{escape(caption)}"><figcaption>{escape(caption)}</figcaption></figure>'


def _row(report: dict[str, Any], prefix: str) -> str:
    """The pictures that there are."""
    figures = []
    for kind, title in _TITLES.items():
        if picture := report["pictures"].get(prefix + kind):
            figures.append(_figure(f"{prefix}{kind}.png", f"{title}, rendered in {picture['seconds']:.1f} s"))
    for kind in ("full", "pruned"):
        if apart := report["differences"].get(prefix + kind):
            caption = f"FLIP of {_TITLES[kind]}: mean {apart['flip']:.4f}; ΔE {apart['delta_e']:.2f}"
            figures.append(_figure(f"{prefix}{kind}_flip.png", caption))
    return f'<div class="row">{"".join(figures)}</div>'


def _materials(report: dict[str, Any]) -> str:
    rows = []
    for row in report["materials"]:
        samples = row.get("samples")
        unread = "" if report["doing"] else "never read"
        used = unread if samples is None else f"{100 * samples['used'] / max(samples['valid'], 1):.1f} %"
        size = row["measured_bytes"]
        cells = [
            escape(row["name"]), f"{100 * row['share']:.1f} %", used, "" if size is None else f"{size / 1e6:.1f} MB",
            str(row["parameters"]["full"]), str(row["parameters"]["pruned"]), str(8 * row["parameters"]["pruned"]),
            f"{row['seconds']['full']:.1f}", f"{row['seconds']['pruned']:.1f}", escape(row.get("verdict", "")),
        ]
        rows.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    heads = ["material", "of what is read", "of its data", "file", "parameters, full", "pruned", "bytes",
             "seconds to fit, full", "pruned", "seen on a sphere"]
    return "<table><tr>" + "".join(f"<th>{head}</th>" for head in heads) + "</tr>" + "".join(rows) + "</table>"


def page(report: dict[str, Any]) -> str:
    """The text of index.html. "doing" says what goes on until all is there, "ended" whether that was cut off."""
    doing, ended = report["doing"], report["ended"]
    tried = ", ".join(
        f"{entry['mean_delta_e']:g}: {entry['parameters']} parameters, FLIP {entry['flip']:.4f}"
        for entry in report["tries"])
    head = f"Ended early, while {doing}" if ended else f"Not finished yet: {doing}"
    sentences = [f"{head if doing else left_text(report['totals'])}."]
    if tried:
        sentences.append(f"Budgets tried, the mean ΔE of a sphere of each material as the scene sees it: {tried}.")
    parts = [
        f"<h1>What {escape(report['scene'])} needs</h1>", f"<p>{escape(' '.join(sentences))}</p>", _row(report, "")]
    if "moved_measured" in report["pictures"]:
        what = ", ".join(f"{name} = {value}" for name, value in report["moved"].items())
        parts += [
            f"<h2>Seen otherwise than it was counted</h2><p>{escape(what)}</p>", _row(report, "moved_")]
    parts += ["<h2>The materials</h2>", _materials(report)]
    style = base64.b64encode(hashlib.sha256(_STYLE.encode()).digest()).decode()
    policy = (
        f"default-src 'none'; style-src 'sha256-{style}'; img-src 'self' file:; base-uri 'none'; form-action 'none'")
    again = '<meta http-equiv="refresh" content="5">' if doing and not ended else ""
    return (
        '<!DOCTYPE html><html lang="en"><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{policy}">{again}'
        '<meta name="viewport" content="width=device-width">'
        f"<title>trilobe-need</title><style>{_STYLE}</style><body>{''.join(parts)}</body></html>\n"
    )
