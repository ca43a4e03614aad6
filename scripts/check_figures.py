#!/usr/bin/python3
"""Checks that figures of the pages are what commands print and tables hold.

Files figures.txt in docs/ and in the folders of experiments bind figures that stand in paragraphs, lists, tables and
blocks of code of pages, word for word:

    your-data.md: **Outliers** are
      trilobe fit synth:copper --out=a
        46.7 dB = PSNR
        0.12 % = a/report.json relative_objective
      nightly: below --prior=0
        9.5 dB = PSNR
      ../experiments/lobes/results/runs.csv
        0.4 = max(psnr_db) - min(psnr_db)

At the margin stand the page, relative to the file's folder, and how the paragraph begins: so much of it as no other
line of the page begins with. An item of a list, or a row of a table, is found in the same way; it lasts until the next
empty line. Below it stand sources, by two spaces, and below a source FIGURE = WHERE, by four. More spaces continue the
line before; # begins a line for readers. The source is one of
- a command, or `above` or `below`: the next block of commands of the page, with flags added to its `trilobe fit` if
  some follow. WHERE is a member of a JSON file that it leaves, or else a regular expression: the last match in what the
  command prints has the value as its group, or as the first number after it. A last digit may be off by one.
- a table, CSV or Markdown, relative to the file's folder. WHERE is an expression in Python of its columns, which are
  numpy arrays, and of the FUNCTIONS below; the figure is its value, rounded.
A figure in % is a share of 1, but as it is where a command prints it. `seven` is 7, `none` 0.

Pages of tables that were not made by this version of the program say so at their top; --write puts or takes that line.
Commits of experiments/same_fits.txt make no other version.
"nightly:" marks a command that takes long. Measured files that it names are looked for in the folder of --data; without
them its figures are not checked, and a line says so.
"""

import argparse
import csv
import functools
import json
import math
import os
import pathlib
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import NamedTuple, Optional

import numpy as np
import page_commands

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "experiments"))
from lab import stats  # noqa: E402
from lab.manifest import load  # noqa: E402

COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
CODE = re.compile(r"^```sh\n(.*?)^```$|(^    (?:trilobe|\./run) [^\n]*\n(?:    [^\n]*\n)*)", re.DOTALL | re.MULTILINE)
BLOCK = re.compile(r"```.*?^```$|.*?(?=\n[ \t]*\n|\Z)", re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
WORDS = ("zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen "
         "seventeen eighteen nineteen twenty").split()
NOTE = re.compile(r"^> \*\*Stale:\*\*.*\n\n", re.MULTILINE)
FILES = ["docs/figures.txt", "experiments/*/figures.txt"]
PAGES = ["*.md", "docs/**/*.md", "experiments/*.md", "experiments/*/README.md", "materials/*.md", "benchmarks/*.md"]
# Sources that decide how a fit of a table comes out. Left out are sampling by renderers, flags that change a
# measurement, reports on it, and readers of samples on no grid, by the names of folders before and after they were
# joined.
CORRUPTION = ("corrupt*", "kinds*", "misaligned.cc", "readings*")
FITS = ["src/model", "src/solvers", "src/fit",
        *(f":(exclude)src/model/{name}" for name in
          ("corruption", *(f"measurement/{of}" for of in CORRUPTION), "evaluate/*bsdf*", "evaluate/half_vector_table*",
           "evaluate/cover_spikes*", "*bsdf*", "half_vector_table*", "cover_spikes*", "measurement/*symptom*",
           "measurement/unmeasured*", "measurement/measurement.cc", "measurement/merl_bins.cc")),
        *(f":(exclude)src/fit/{name}" for name in
          ("guess_error*", "scene", "reports", "study", "export", "open_pbr"))]
# Steps after the solver, which raw fits do without, and so do these programs.
FINISH = [f":(exclude)src/fit/{name}" for name in ("finish", "finish_fit.cc", "held_out*", "prune")]
UNFINISHED = ("awls_equality", "random_starts", "stiff")
# Further sources that these experiments depend on.
EVALUATED = ["src/model/evaluate",
             *(f"src/model/{name}" for name in ("*bsdf*", "half_vector*", "cover_*", "sampling_*"))]
ALSO = {"sampling": EVALUATED, "appearance": EVALUATED, "cloths": EVALUATED,
        "diagnosis": ["src/model/measurement", "src/model/corruption"],
        "robustness": ["src/model/measurement", "src/model/corruption"], "scene": ["src/fit/scene"],
        "reads": ["src/fit/scene"]}
FUNCTIONS: dict[str, Callable[..., object]] = {
    "median": stats.median, "quantile": stats.quantile, "mean": np.mean, "max": np.nanmax, "min": np.nanmin,
    "geometric_mean": lambda values: np.exp(np.mean(np.log(values))), "share": np.mean, "count": np.sum, "sum": np.sum,
    "abs": np.abs, "sort": np.sort, "isin": np.isin,
    # statistic(values) of each group, in the order of the groups' names
    "each": lambda group, statistic, values: np.array([statistic(values[group == one]) for one in np.unique(group)]),
}


class Figure(NamedTuple):
    """A figure of a page, and where it comes from; a table lies relative to the folder."""

    page: pathlib.Path
    folder: pathlib.Path
    text: str
    source: str
    where: str
    nightly: bool

    @property
    def is_of_table(self) -> bool:
        """Whether the source is a table and no command."""
        return self.source.endswith((".csv", ".md")) and " " not in self.source


class Wrong(Exception):
    """Says what is wrong with a figure."""


def number(text: str) -> tuple[float, float]:
    """The value of a figure and of its last digit."""
    word = text.split()[0].lower().replace("none", "zero")
    if word in WORDS:
        return float(WORDS.index(word)), 1
    found = NUMBER.search(text.replace("−", "-").replace(",", ""))
    if not found:
        raise Wrong("is no number")
    mantissa, _, exponent = found[0].partition("e")
    digit = 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))
    return (float(found[0]) / 100, digit / 100) if "%" in text else (float(found[0]), digit)


def commands(source: str, page: str, start: int) -> str:
    """The commands of a source; those of a block of the page with the flags that follow `above` or `below`."""
    place, _, flags = source.partition(" ")
    if place not in ("above", "below"):
        return source
    blocks = [block for block in CODE.finditer(page)
              if (block.end() <= start if place == "above" else block.start() >= start)]
    if not blocks:
        raise Wrong(f"has no block of commands {place}")
    block = blocks[-1 if place == "above" else 0]
    lines = (block[1] or block[2]).replace("\\\n", " ").replace("./run ", "trilobe ")
    return re.sub(r"^( *trilobe fit .*)$", rf"\1 {flags}", lines, flags=re.MULTILINE) if flags else lines


class Paragraph(NamedTuple):
    """A paragraph of a page by how it begins, and by each of its sources FIGURE = WHERE."""

    page: pathlib.Path
    begins: str
    sources: list[tuple[str, list[str]]]


def paragraphs(file: pathlib.Path) -> Iterator[Paragraph]:
    """What a file binds figures of."""
    lines: list[str] = []
    for line in file.read_text().splitlines():
        if line.startswith("      ") and lines:
            lines[-1] += " " + line.strip()
        elif line.strip() and not line.lstrip().startswith("#"):
            lines.append(line)
    last: Optional[Paragraph] = None
    for line in lines:
        text, depth = line.strip(), len(line) - len(line.lstrip())
        if depth == 0:
            if last:
                yield last
            name, colon, begins = text.partition(": ")
            if not colon:
                raise Wrong(f"`{line}` names no page and paragraph")
            last = Paragraph(pathlib.Path(os.path.normpath(file.parent / name)), begins, [])
        elif depth == 2 and last:
            last.sources.append((text, []))
        elif depth == 4 and last and last.sources:
            last.sources[-1][1].append(text)
        else:
            raise Wrong(f"`{line}` stands below no {'source' if depth == 4 else 'paragraph'}")
    if last:
        yield last


def region(text: str, begins: str) -> tuple[int, str]:
    """Where in a page the paragraph lies that begins so, and its words."""
    shown = COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), text)
    found = list(re.finditer("^" + r"\s+".join(map(re.escape, begins.split())), shown, re.MULTILINE))
    if len(found) != 1:
        raise Wrong(f"{len(found) or 'no'} paragraphs begin with `{begins}`")
    block = BLOCK.match(shown, found[0].start())
    return found[0].start(), " ".join(block[0].split()) if block else ""


def figures(paragraph: Paragraph, folder: pathlib.Path) -> Iterator[Figure]:
    """Those of a paragraph; Wrong if one does not stand in it."""
    if not paragraph.page.exists():
        raise Wrong("is bound, but does not exist")
    text = paragraph.page.read_text()
    start, there = region(text, paragraph.begins)
    for source, bound in paragraph.sources:
        command = source.removeprefix("nightly: ")
        if not bound:
            raise Wrong(f"`{command}` binds no figure")
        for binding in bound:
            figure, equals, where = binding.partition(" = ")
            if not equals or not re.search(rf"(?<![\w.,]){re.escape(figure)}(?![\w%]|[.,]\d)", there, re.IGNORECASE):
                raise Wrong(f"`{binding}`: no `{figure}` stands in `{paragraph.begins}`")
            try:
                run = commands(command, text, start)
            except Wrong as wrong:
                raise Wrong(f"`{binding}` {wrong}") from wrong
            yield Figure(paragraph.page, folder, figure, run, where, command != source)


def all_figures(root: pathlib.Path) -> tuple[dict[pathlib.Path, list[Figure]], dict[pathlib.Path, list[str]]]:
    """The figures of each page, and what is wrong with how they are bound."""
    bound: dict[pathlib.Path, list[Figure]] = {}
    wrong: dict[pathlib.Path, list[str]] = {}
    for file in (file for pattern in FILES for file in sorted(root.glob(pattern))):
        try:
            for paragraph in paragraphs(file):
                try:
                    bound.setdefault(paragraph.page, []).extend(figures(paragraph, file.parent))
                except Wrong as error:
                    wrong.setdefault(paragraph.page, []).append(str(error))
        except Wrong as error:
            wrong.setdefault(file, []).append(str(error))
    return bound, wrong


def rows(path: pathlib.Path) -> Iterator[list[list[str]]]:
    """The lines of each table of a file in CSV or Markdown; the first of them has the names."""
    if path.suffix == ".csv":
        with path.open() as file:
            yield list(csv.reader(file))
    for lines in re.findall(r"(?:^\|.*\n)+", path.read_text(), re.MULTILINE) if path.suffix == ".md" else []:
        yield [[cell.replace("**", "").strip() for cell in line.strip("|").split(" | ")]
               for line in lines.split("\n") if line and not line.startswith("| ---")]


def column(name: str, cells: list[str]) -> np.ndarray:
    """Numbers, nan where nothing stands, percents as shares, the median of "2 [1, 3]"; or else text."""
    percent = ", %" in name or any(cell.endswith("%") for cell in cells)
    cells = ["nan" if cell in ("", "–") else cell.replace("−", "-") for cell in cells]
    found = [re.fullmatch(rf"(nan|-?inf|{NUMBER.pattern})( ?%)?( \[.*\])?", cell) for cell in cells]
    if not all(found):
        return np.array(cells)
    return np.array([float(one[1]) for one in found if one]) / (100 if percent else 1)


@functools.cache
def table(path: pathlib.Path) -> dict[str, np.ndarray]:
    """The columns of a file's tables, the first of a name, of which letters, digits and _ are left."""
    columns: dict[str, np.ndarray] = {}
    for names, *lines in rows(path):
        for name, *cells in zip(names, *lines):
            columns.setdefault(re.sub(r"\W+", "_", name).strip("_"), column(name, cells))
    return columns


def printed(figure: Figure, done: page_commands.Done) -> float:
    """The value that a command has printed, or left in a JSON file."""
    file = re.fullmatch(r"(\S+\.json) (\S+)", figure.where)
    if file:
        value = json.loads((done.folder / file[1]).read_text())
        for member in file[2].split("."):
            value = value[int(member) if isinstance(value, list) else member]
        return float(value)
    matches = list(re.finditer(figure.where, done.output))
    if not matches:
        raise Wrong(f"{figure.where} is not printed:\n{done.output}")
    last = matches[-1]
    found = NUMBER.search(last[1] if last.groups() else done.output[last.end():])
    if not found:
        raise Wrong(f"{figure.where} has no number after it:\n{done.output}")
    return float(found[0]) / (100 if "%" in figure.text else 1)


def differs(figure: Figure, value: float, off: float) -> str:
    """Says how a figure is wrong, if its value may be `off` by so many of its last digits; empty if it is right."""
    given, digit = number(figure.text)
    if abs(value - given) <= (off + 1e-6) * digit:
        return ""
    places = max(0, round(-math.log10(digit)) - (2 if "%" in figure.text else 0))
    shown = f"{value * 100:.{places}f} %" if "%" in figure.text else f"{value:.{places}f}"
    return f"{figure.text} is {shown} ({value:.6g}) by `{figure.where}` of `{figure.source}`"


def of_table(figure: Figure) -> str:
    """Says how a figure of a table is wrong; empty if it is right."""
    try:
        columns = table(figure.folder / figure.source)
        value = float(eval(figure.where, {"__builtins__": {}}, {**columns, **FUNCTIONS}))  # noqa: S307
        return differs(figure, value, 0.5)
    except (OSError, NameError, TypeError, ValueError, IndexError, SyntaxError, Wrong) as error:
        return f"{figure.text}: `{figure.where}` of {figure.source}: {error}"


def of_command(bound: list[Figure], root: pathlib.Path, data: Optional[pathlib.Path]) -> Iterator[str]:
    """Says how figures of one command are wrong."""
    command = bound[0].source
    with page_commands.run(command, root, data) as done:
        if done.absent:
            print(f"not checked: {len(bound)} figures of `{command.strip()}` ({done.absent} is not in the folder of "
                  "--data)", flush=True)
        elif not done.succeeded:
            yield f"`{command}` fails:\n{done.output}"
        else:
            print(f"{len(bound)} figures of `{command.strip()}`", flush=True)
            for figure in bound:
                try:
                    wrong = differs(figure, printed(figure, done), 1)
                except (OSError, KeyError, TypeError, ValueError, IndexError, Wrong) as error:
                    wrong = f"{figure.text} of `{command}`: {error}"
                if wrong:
                    yield f"{figure.page.relative_to(root)}: {wrong}"


def git(root: pathlib.Path, *arguments: str) -> Optional[str]:
    """The output of git; None where it fails."""
    done = subprocess.run(["git", *arguments], cwd=root, capture_output=True, text=True, check=False)
    return done.stdout.strip() if done.returncode == 0 else None


@functools.cache
def same_fits(root: pathlib.Path) -> dict[str, set[str]]:
    """Commits that are known to leave fits as they were, but for those of some experiments."""
    lines = (root / "experiments/same_fits.txt").read_text().splitlines()
    same = {}
    for line in lines:
        if line.startswith("#"):
            continue
        commit, *words = line.split()
        changed = line.split(":")[0].split()[2:] if words[0] == "but" else []
        same[git(root, "rev-parse", commit) or line] = set(changed)
    return same


def has_changed(root: pathlib.Path, revision: str, paths: list[str], experiment: str) -> bool:
    """Whether a commit since the revision may have changed fits of the experiment, which depend on the paths."""
    commits = (git(root, "log", "--format=%H", f"{revision}..HEAD", "--", *paths) or "").split()
    same = {commit for commit, changed in same_fits(root).items() if experiment not in changed}
    return not same.issuperset(commits) or git(root, "diff", "--quiet", "HEAD", "--", *paths) is None


@functools.cache
def staleness(results: pathlib.Path, root: pathlib.Path) -> str:
    """Why results are not those of this version of the program; empty if they are."""
    if (results / "machine.json").exists():
        return ""  # times, which it says the machine and the revision of
    if not (results / "manifest.json").exists():
        return "without a manifest"
    made = json.loads((results / "manifest.json").read_text())
    revisions = sorted({str(revision or "an unknown revision") for revision in
                        [*(program["revision"] for program in made["programs"]), made["tabulated_at"]]})
    unfinished = (made["settings"].get("flags") or {}).get("raw") or results.parent.name in UNFINISHED
    fits = FITS + FINISH if unfinished else FITS
    unknown = [revision for revision in revisions if git(root, "merge-base", "--is-ancestor", revision, "HEAD") is None]
    reasons = []
    if unknown:
        reasons.append(f"by sources that are not in this repository ({', '.join(unknown)})")
    elif any(has_changed(root, revision, paths, results.parent.name)
             for paths in (fits, ALSO.get(results.parent.name)) if paths for revision in revisions):
        reasons.append(f"before changes of fits ({', '.join(revisions)})")
    settings = load(results.parent / "manifest.json", made["form"])
    if any(made["settings"].get(name) != value for name, value in settings.items()
           if name != "question" and value is not None):
        reasons.append("with other settings")
    return ", ".join(reasons)


def note(page: pathlib.Path, bound: list[Figure], root: pathlib.Path) -> str:
    """The line that a page needs at its top, if any."""
    of_tables = {(figure.folder / figure.source).resolve().parent for figure in bound if figure.is_of_table}
    tables = {folder for folder in of_tables if folder.name.startswith("results")}  # the book of records has no version
    own = {folder for folder in page.parent.glob("results*") if (folder / "manifest.json").exists()}
    stale = {folder: why for folder in sorted(tables | own) if (why := staleness(folder, root))}
    if not stale:
        return ""
    if own:
        reasons = "; ".join(f"`{folder.name}` was made {why}" for folder, why in stale.items() if folder in own)
    else:
        reasons = "see the pages of " + ", ".join(sorted({folder.parent.name for folder in stale}))
    return f"> **Stale:** {reasons}.\n\n"


def set_note(page: pathlib.Path, line: str, write: bool) -> str:
    """Says how the note of a page is wrong; mends it instead if `write`."""
    text = page.read_text()
    bare = NOTE.sub("", text, 1)
    title, between, rest = bare.partition("\n\n")
    wanted = f"{title}{between}{line}{rest}"
    if wanted == text:
        return ""
    if write:
        page.write_text(wanted)
        return ""
    return f"its note of stale tables is not up to date: scripts/check_figures.py --write ({line.strip() or 'none'})"


def main() -> int:
    """Looks at all tables, and then at commands."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tables", action="store_true", help="leave out commands")
    parser.add_argument("--quick", action="store_true", help="leave out commands that are marked nightly")
    parser.add_argument("--write", action="store_true", help="write the notes of stale tables")
    parser.add_argument("--data", type=pathlib.Path, help="where measured files lie, at any depth")
    parser.add_argument("--root", type=pathlib.Path, help="of the repository",
                        default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("pages", nargs="*", help="pages to look at (all)")
    options = parser.parse_args()
    root = options.root.resolve()
    pages = [pathlib.Path(os.path.abspath(name)) for name in options.pages] or [
        page for pattern in PAGES for page in sorted(root.glob(pattern))]
    has_history = git(root, "rev-parse", "--is-shallow-repository") == "false"
    if not has_history:
        print("not checked: whether tables are stale, since the history is not here")
    bound_in, unbound = all_figures(root)
    if not options.pages:
        pages += sorted({*bound_in, *unbound} - set(pages))
    wrong: list[str] = []
    by_command: dict[str, list[Figure]] = {}
    for page in pages:
        bound = bound_in.get(page, [])
        found = unbound.get(page, []) + [of_table(figure) for figure in bound if figure.is_of_table]
        if has_history and page.suffix == ".md" and page not in unbound:
            found.append(set_note(page, note(page, bound, root), options.write))
        wrong += [f"{page.relative_to(root)}: {what}" for what in found if what]
        for figure in bound:
            if not (figure.is_of_table or options.tables or options.quick and figure.nightly):
                by_command.setdefault(figure.source, []).append(figure)
    for of_one in by_command.values():
        wrong += of_command(of_one, root, options.data)
    for line in wrong:
        print(line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
