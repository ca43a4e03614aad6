"""Fits by `trilobe fit`: how they are asked for, so that equal ones are made once, and read."""
import csv
import functools
import itertools
import json
import math

from lab.units import FOLDER, Unit


def _flag(name, value):
    if isinstance(value, bool):
        return f"--{name}" if value else f"--no{name}"
    return f"--{name}={value}"


def words(flags):
    """Flags of the program, {"max_iterations": 500, "course": True}, as its words."""
    return [_flag(name, flags[name]) for name in sorted(flags)]


def fit(setting, source, solver, flags=None, start="analytic", seed=1, threads=2,
        weighting="compressive", noise=0, repeat=1, **labels):
    """The unit of one fit.

    solver: a name in the manifest's "solvers", whose flags it has, or a solver of the program.
    flags: more of `trilobe fit`, {"max_iterations": 500}, that the solver's own take precedence of.
    repeat: the same fit is made once for each number, where its times are the question.
    """
    flags = {"solver": solver, "init": start, "seed": seed, "threads": threads,
             "weighting": weighting, "noise": noise, **(flags or {}),
             **setting.manifest.get("solvers", {}).get(solver, {})}
    again = f"-repeat{repeat}" if repeat > 1 else ""
    return Unit(path=f"fit/{source.name}/{solver}-{start}-{weighting}-{threads}t{again}",
                program=setting.program(),
                arguments=("fit", source.path, f"--out={FOLDER}", *words(flags)),
                product="report.json",
                labels={"material": source.name, "solver": solver, "start": start, "seed": seed,
                        "threads": threads, "weighting": weighting, "noise": noise,
                        "repeat": repeat, **labels})


def planned(setting):
    """The fits of the manifest's "runs", without repetitions within runs of one name.

    A run is a set of fits: {"solvers": [...], "every": 4, "starts": [...], "seeds": [...],
    "threads": [...], "weightings": [...], "noises": [...], "repeats": 2, "flags": {...}}, all but
    the first with a default. It stands for every combination on every 4th material of each list;
    its flags come on top of the manifest's "flags". Its "name", if it has one, is a label of its
    fits.
    """
    units = {}
    for run in setting.manifest["runs"]:
        flags = {**setting.manifest.get("flags", {}), **run.get("flags", {})}
        for source, solver, start, seed, threads, weighting, noise, repeat in itertools.product(
                setting.every(run.get("every", 1)), run["solvers"],
                run.get("starts", ["analytic"]), run.get("seeds", [1]), run.get("threads", [2]),
                run.get("weightings", ["compressive"]), run.get("noises", [0]),
                range(1, 1 + run.get("repeats", 1))):
            unit = fit(setting, source, solver, flags, start, seed, threads, weighting, noise,
                       repeat, run=run.get("name", ""))
            units.setdefault((unit.key, unit.labels["run"]), unit)
    return list(units.values())


class Fit:
    """What `trilobe fit` wrote into a folder (docs/file-formats.md)."""

    def __init__(self, folder):
        self.folder = folder
        self.report = json.loads((folder / "report.json").read_text())

    def _rows(self, file):
        with open(self.folder / file, newline="") as text:
            return [{key: float(value) if value else math.nan for key, value in row.items()}
                    for row in csv.DictReader(text)]

    @property
    def before(self):
        """Seconds from the start of reading to the solver's start."""
        seconds = self.report["seconds"]
        return seconds["read"] + seconds["prepare"] + seconds["init"]

    @functools.cached_property
    def trace(self):
        """Rows of trace.csv; `clock`: seconds from the start of reading, without those that only
        the trace has cost, which are shared out evenly."""
        rows = self._rows("trace.csv")
        a_row = self.report["phases"]["tracing"] / len(rows)
        for row in rows:
            row["clock"] = self.before + row["seconds"] - a_row * (row["iteration"] + 1)
        return rows

    @functools.cached_property
    def course(self):
        """Rows of course.csv, of a fit with the flag "course": scores of models on the way;
        `clock` as in the trace."""
        clock = {row["iteration"]: row["clock"] for row in self.trace}
        rows = self._rows("course.csv")
        for row in rows:
            row["clock"] = clock[row["iteration"]]
        return rows
