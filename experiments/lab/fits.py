"""Fits by `trilobe fit`: how they are asked for, so that equal ones are made once, and read."""
import csv
import functools
import itertools
import json
import math
import pathlib
import re

from lab import UsageError
from lab.units import FOLDER, Unit

# Clocks of times: the one on the wall, or the processors of all threads, which is what a fit takes whatever else runs
# beside it.
CLOCKS = {"wall": "seconds", "processor": "processor seconds"}
DEFAULT = "default"  # the weighting that the program takes if it is told none
# The members of a run, and what they are if they are not given.
RUN = {"solvers": None, "every": 1, "starts": ["analytic"], "seeds": [1], "threads": [2],
       "weightings": [DEFAULT], "repeats": 1, "flags": {}, "name": ""}
# A fit with a time limit that takes ten times as long, and this, hangs.
PATIENCE_S = 600


def _flag(name, value):
    if isinstance(value, bool):
        return f"--{name}" if value else f"--no{name}"
    return f"--{name}={value}"


def words(flags):
    """Flags of the program, {"max_iterations": 500, "convergence": True}, as its words."""
    return [_flag(name, flags[name]) for name in sorted(flags)]


def file_name(text):
    """A text as part of a file's name: "power:epsilon=1" becomes "power-epsilon-1"."""
    return re.sub(r"[^\w.+-]+", "-", text)


def of_weighting(setting, weighting):
    """The flags that stand for a weighting: those that the manifest gives the name, if it does."""
    own = {} if weighting == DEFAULT else {"weighting": weighting}
    return setting.manifest.get("weightings", {}).get(weighting, own)


def fit(setting, source, solver, flags=None, start="analytic", seed=1, threads=2,
        weighting=DEFAULT, repeat=1, **labels):
    """The unit of one fit.

    solver: a name in the manifest's "solvers", whose flags it has, or a solver of the program. A
        flag "program" there is no flag, but another program that knows the solver.
    weighting: a name in the manifest's "weightings", whose flags it has, or a weighting of the
        program, or DEFAULT.
    flags: more of `trilobe fit`, {"max_iterations": 500}, that the solver's own take precedence of.
    repeat: the same fit is made once for each number, where its times are the question.
    """
    flags = {"solver": solver, "init": start, "seed": seed, "threads": threads, "noise": 0,
             **of_weighting(setting, weighting), **setting.reading(source), **(flags or {}),
             **setting.manifest.get("solvers", {}).get(solver, {})}
    program = flags.pop("program", None)
    limit = flags.get("max_seconds", 0)
    again = f"-repeat{repeat}" if repeat > 1 else ""
    return Unit(path=f"fit/{source.name}/{solver}-{start}-{file_name(weighting)}-{threads}t{again}",
                program=pathlib.Path(program).resolve() if program else setting.program(),
                arguments=("fit", source.path, f"--out={FOLDER}", "--noplots", *words(flags)),
                product="report.json", timeout_s=10 * limit + PATIENCE_S if limit else None,
                labels={"material": source.name, "solver": solver, "start": start, "seed": seed,
                        "threads": threads, "weighting": weighting, "repeat": repeat, **labels})


def checked(runs):
    """A manifest's runs; UsageError if they are none."""
    if not isinstance(runs, list):
        raise UsageError("the manifest's \"runs\" are not a list")
    for place, run in enumerate(runs):
        if not isinstance(run, dict) or "solvers" not in run:
            raise UsageError(f"runs.{place} of the manifest has no \"solvers\"")
        for name, value in run.items():
            if name not in RUN:
                raise UsageError(f"runs.{place}.{name} of the manifest: not one of "
                                 f"{', '.join(RUN)}")
            if name == "every" and isinstance(value, dict) and all(
                    of in ("MERL", "RGL", "own") and type(n) is int and n >= 1
                    for of, n in value.items()):
                continue
            kind = list if name == "solvers" else type(RUN[name])
            if type(value) is not kind or (kind is int and value < 1):
                what = {list: "a list", dict: "an object", str: "text", int: "1 or more"}[kind]
                raise UsageError(f"runs.{place}.{name} of the manifest is {value!r}, not {what}")
    return runs


def planned(setting):
    """The fits of the manifest's "runs", without repetitions within runs of one name.

    A run is a set of fits: {"solvers": [...], "every": 4, "starts": [...], "seeds": [...],
    "threads": [...], "weightings": [...], "repeats": 2, "flags": {...}}, all but the first with a
    default. It stands for every combination on every 4th material of each list ({"MERL": 4}: of
    that list, and on all of the others); its flags come on
    top of the manifest's "flags". Its "name", if it has one, is a label of its fits. Raises
    UsageError for any other member, or one of another type.
    """
    units = {}
    for given in checked(setting.manifest["runs"]):
        run = {**RUN, **given}
        flags = {**setting.manifest.get("flags", {}), **run["flags"]}
        for source, solver, start, seed, threads, weighting, repeat in itertools.product(
                setting.every(run["every"]), run["solvers"], run["starts"], run["seeds"],
                run["threads"], run["weightings"], range(1, 1 + run["repeats"])):
            unit = fit(setting, source, solver, flags, start, seed, threads, weighting,
                       repeat, run=run["name"])
            units.setdefault((unit.key, unit.labels["run"]), unit)
    return list(units.values())


def clock(setting):
    """The manifest's "clock", one of CLOCKS."""
    name = setting.manifest.get("clock", "wall")
    if name not in CLOCKS:
        raise UsageError(f"the manifest's \"clock\" is {name!r}, not one of {', '.join(CLOCKS)}")
    return name


class Fit:
    """The files that `trilobe fit` wrote into a folder (docs/file-formats.md).

    clock: one of CLOCKS.
    """

    def __init__(self, folder, clock="wall"):
        self.folder = folder
        self.by_processor = clock == "processor"
        self.report = json.loads((folder / "report.json").read_text())
        lacking = [name for name in ("objective", "seconds", "phases") if name not in self.report]
        if lacking:
            raise UsageError(f"{folder / 'report.json'} has no {', '.join(lacking)} "
                             "(docs/file-formats.md)")

    def _rows(self, file):
        with open(self.folder / file, newline="") as text:
            return [{key: float(value) if value else math.nan for key, value in row.items()}
                    for row in csv.DictReader(text)]

    @property
    def before(self):
        """Seconds until the solver has its start."""
        return self.trace[0]["clock"]

    @property
    def solved(self):
        """Seconds until the solver has ended."""
        return self.trace[-1]["clock"]

    @property
    def all(self):
        """Seconds of everything, the tracing as well."""
        if self.by_processor:
            return json.loads((self.folder / "unit.json").read_text())["processor_seconds"]
        return sum(self.report["seconds"].values())

    @functools.cached_property
    def trace(self):
        """Rows of trace.csv; `clock`: seconds from the start of reading, without those that only
        the trace has cost, which are shared out evenly. On one thread these are the same by both
        clocks."""
        rows = self._rows("trace.csv")
        a_row = self.report["phases"]["tracing"] / len(rows)
        reading = sum(self.report["seconds"][phase] for phase in ("read", "prepare", "init"))
        for row in rows:
            now = row["processor_seconds"] if self.by_processor else reading + row["seconds"]
            row["clock"] = now - a_row * (row["iteration"] + 1)
        return rows

    @functools.cached_property
    def convergence(self):
        """Rows of convergence.csv, of a fit with the flag "convergence": scores of models on the way;
        `clock` as in the trace."""
        clock = {row["iteration"]: row["clock"] for row in self.trace}
        rows = self._rows("convergence.csv")
        for row in rows:
            row["clock"] = clock[row["iteration"]]
        return rows
