"""All pages, with their pictures and tables, in one HTML file that needs nothing else.

The text of a page speaks of the run that is published with it. Where tables and pictures of another run
take the place of those, the page says which run that is, and its text, whose figures are others, is left
out.
"""
import base64
import dataclasses
import html
import json
import mimetypes
import pathlib
import re

import markdown

from lab import tables

STYLE = """
body { font: 16px/1.5 sans-serif; color: #222; max-width: 62rem; margin: 2rem auto;
       padding: 0 1rem; }
h1 { border-top: 3px solid #0072B2; padding-top: .6rem; margin-top: 4rem; }
header h1 { border: 0; margin-top: 0; }
table { border-collapse: collapse; font-size: 13px; margin: 1rem 0; }
th, td { border-bottom: 1px solid #ddd; padding: .15rem .6rem; text-align: right;
         white-space: nowrap; background: #fff; }
th { white-space: normal; vertical-align: bottom; position: sticky; top: 0; z-index: 1; }
th:first-child, td:first-child { text-align: left; position: sticky; left: 0; }
th:first-child { z-index: 2; }
.table { overflow: auto; max-height: 32rem; width: max-content; min-width: 100%;
         max-width: calc(100vw - 3rem); position: relative; left: 50%;
         transform: translateX(-50%); }
.table table { margin: 0; }
@media print { .table { overflow: visible; max-height: none; } }
img { max-width: 100%; }
figure { margin: 1.5rem 0; } figcaption { color: #555; font-size: 14px; }
pre, code { background: #f4f4f4; font-size: 13px; } pre { padding: .6rem; overflow-x: auto; }
details { margin: 1rem 0; }
.missing { color: #D55E00; }
.run { border-left: 4px solid #D55E00; padding-left: .8rem; }
"""

# Pictures and styles stand in the page; nothing runs, and nothing comes from a network.
POLICY = ("default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; "
          "form-action 'none'")

FORMS = {"full": "full form", "quick": "quick form, whose figures mean nothing",
         "anisotropic": "anisotropic form"}


@dataclasses.dataclass(frozen=True)
class Results:
    """The folder with tables and pictures of a form of an experiment: those that are published with its page, or of
    another run."""

    folder: pathlib.Path | None
    published: bool = True

    @property
    def run(self):
        """The manifest that the run has left; None where there is none."""
        path = self.folder / "manifest.json" if self.folder else None
        return json.loads(path.read_text()) if path and path.exists() else None


_LINK_ALONE = re.compile(r"^(!?)\[([^\]]*)\]\(results(_anisotropic)?/([^)\s]+)\)$", re.MULTILINE)
_IMAGE = re.compile(r'<img alt="([^"]*)" src="([^"]+)"\s*/?>')


def _data_uri(path):
    kind = mimetypes.guess_type(path.name)[0]
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"


def _cell(value):
    return "" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


def _csv_table(path):
    rows = tables.read(path)
    if not rows:
        return ""
    return tables.markdown(list(rows[0]), [[_cell(value) for value in row.values()]
                                           for row in rows])


def _inline(text):
    """A line of Markdown as HTML without a paragraph around it."""
    return markdown.markdown(text).removeprefix("<p>").removesuffix("</p>")


def _content(match, results):
    """The target of a link that stands alone in its line: a picture with its caption, a table, a text."""
    picture, caption, form, name = match.groups()
    folder = results["anisotropic" if form else "full"].folder
    path = folder / name if folder else None
    if path is None or not path.exists():
        return f'<p class="missing">Not there yet: {_inline(caption)}</p>'
    if picture:
        return (f'<figure><img alt="" src="{_data_uri(path)}"/>'
                f"<figcaption>{_inline(caption)}</figcaption></figure>")
    text = _csv_table(path) if path.suffix == ".csv" else path.read_text()
    return f"{caption}:\n\n{text}"


def _which_run(form, results):
    """A sentence."""
    named = "" if form == "full" else f" of the {form} form"
    run = results.run
    if results.published:
        return f"Tables and pictures{named} are the published ones."
    if run is None:
        return f"Tables and pictures{named} are of another run than the published ones."
    materials = ", ".join(run["sources"][:8]) + (", …" if len(run["sources"]) > 8 else "")
    return (f"Tables and pictures{named} are of a run of {run['date']}, {FORMS[run['form']]}, on "
            f"{len(run['sources'])} material{'s' if len(run['sources']) != 1 else ''} ({materials}).")


def _without_text(experiment, text, results):
    """The page's title, which run it shows, and what the links that stand alone in a line lead to."""
    sentences = [_which_run(form, of) for form, of in results.items() if of.folder]
    shown = "\n\n".join(_content(match, results) for match in _LINK_ALONE.finditer(text))
    return (f'# {experiment.title}\n\n<p class="run">{html.escape(" ".join(sentences))} '
            "The text of the page speaks of the published run and is left out; it is in "
            f"<code>experiments/{experiment.name}/README.md</code>.</p>\n\n{shown}\n")


def _page(experiment, results):
    """The page with each link that stands alone in its line and leads into results/ or
    results_anisotropic/ replaced by what it leads to."""
    text = experiment.page.read_text()
    if not all(of.published for of in results.values()):
        return _without_text(experiment, text, results)
    return _LINK_ALONE.sub(lambda match: _content(match, results), text)


def _embed_images(text, folder):
    """Pictures that are still links: those of a text in the results, relative to them."""
    def embedded(match):
        path = folder / match.group(2) if folder else None
        if match.group(2).startswith("data:") or path is None or not path.exists():
            return match.group(0)
        return f'<img alt="{match.group(1)}" src="{_data_uri(path)}"/>'
    return _IMAGE.sub(embedded, text)


def _section(experiment, results):
    page = _page(experiment, results)
    body = markdown.markdown(page, extensions=["tables", "fenced_code"])
    body = _embed_images(body, results["full"].folder)
    body = re.sub(r'<a href="(?![a-z]+:|#)[^"]*">(.*?)</a>', r"\1", body)  # other pages: not here
    body = body.replace("<table>", '<div class="table"><table>').replace("</table>",
                                                                         "</table></div>")
    body = body.replace("<h1>", f'<h1 id="{experiment.name}">', 1)
    record = results["full"].run
    if record is not None:
        body += ("<details><summary>Settings, machine and versions of this run "
                 f"({record['form']} form, {record['units']['made']} of {record['units']['all']} "
                 f"units, {record['seconds'] / 3600:.2f} h)</summary>"
                 f"<pre>{html.escape(json.dumps(record, indent=1))}</pre></details>")
    return f"<section>{body}</section>"


def in_order(experiments, index):
    """The experiments in the order in which a page links to theirs, others after."""
    text = index.read_text()
    places = {e.name: text.find(f"({e.name}/README.md)") for e in experiments}
    return sorted(experiments, key=lambda e: (places[e.name] < 0, places[e.name], e.name))


def write(path, experiments, results_of):
    """Writes the page. results_of(experiment, form): the Results of a form."""
    contents = "".join(f'<li><a href="#{e.name}">{html.escape(e.title)}</a></li>'
                       for e in experiments)
    sections = "\n".join(
        _section(e, {form: results_of(e, form) for form in ("full", "anisotropic")})
        for e in experiments)
    part = path.with_name(f".{path.name}.part")
    part.write_text(
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"/>'
        f'<meta http-equiv="Content-Security-Policy" content="{POLICY}"/><title>Experiments with '
        f"Trilobe</title><style>{STYLE}</style></head><body><header><h1>Experiments with Trilobe"
        f"</h1><ol>{contents}</ol></header>\n{sections}\n</body></html>\n")
    part.rename(path)
