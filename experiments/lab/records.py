"""The book of records: the lowest E known of each measurement, weighting and form of model.

A record is never raised. A fit lowers it if `trilobe score` finds the same E of its model, which is deterministic:
the command, at the revision that the book names, makes the model again.
"""
import functools
import json
import math
import pathlib
import subprocess

from lab import UsageError, tables

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "records"
BOOK = FOLDER / "records.csv"

# What a record is of. The checksum is that of the measured values (`source_xxh128` of a report).
KEY = ("material", "source_xxh128", "valid_samples", "weighting", "model", "lobes", "parameters")
# Flags that give a fit other data, or lower another E, than the measurement and the weighting say.
OTHER_DATA = ("corrupt", "missing", "dark_noise", "outliers", "extrapolated", "tilt", "cosine", "scale",
              "azimuth", "robust", "scene")
# As precisely as a model file's E can be found again.
AGREES = 1e-9


def key_of(report, material):
    """The record's key of a fit, by its report."""
    return (material, report["source_xxh128"], report["valid_samples"], report["weighting"], report["model"],
            report["lobes"], report["parameters"])


def read(path=BOOK):
    """{key: row}, empty without a book."""
    if not path.exists():
        return {}
    return {tuple(row[name] for name in KEY): row for row in tables.read(path)}


@functools.cache
def _published():
    return read()


def lowest(report, material):
    """The lowest E known for the measurement, weighting and form of this fit; infinite if none is."""
    row = _published().get(key_of(report, material))
    return row["objective"] if row else math.inf


def excess(objective, report, material):
    """How far an E is above the record of this fit's measurement, weighting and form; None without a record."""
    least = lowest(report, material)
    return objective / least - 1 if 0 < least < math.inf else None


def _arguments(record):
    """The words of a unit's `trilobe fit`; None if it is no fit of a measurement as it is."""
    words = record["command"]
    if len(words) < 3 or words[1] != "fit":
        return None
    names = {word.removeprefix("--").partition("=")[0] for word in words[3:]}
    if names & set(OTHER_DATA) or "--noise=0" not in words:
        return None
    return words[2:]


def _shown(arguments):
    """The command as others can type it: without this machine's folders."""
    source, *flags = arguments
    left_out = ("--out=", "--noplots", "--convergence", "--noise=0", "--threads=")
    kept = [word for word in flags if not word.startswith(left_out)]
    return " ".join(["trilobe fit", pathlib.PurePath(source).name, *kept])


def candidates(units):
    """(key, row, model, source, flags that read the measurement) of each fit in a folder of units."""
    for folder in sorted(units.glob("fit/*/*")):
        if not ((folder / "unit.json").is_file() and (folder / "report.json").is_file()):
            continue
        record = json.loads((folder / "unit.json").read_text())
        arguments = _arguments(record)
        report = json.loads((folder / "report.json").read_text())
        if arguments is None or report["prior"] or not math.isfinite(report["objective"]):
            continue
        material = folder.parent.name
        key = key_of(report, material)
        reading = [word for word in arguments if word.startswith(("--max_angle=", "--weighting="))]
        row = {**dict(zip(KEY, key)), "objective": report["objective"],
               "relative_objective": report["relative_objective"], "solver": report["solver"],
               "command": _shown(arguments), "revision": record["revision"]}
        yield key, row, folder / "model.json", arguments[0], reading


def _confirmed(program, row, model, source, reading):
    """Whether `trilobe score` finds the E of the report."""
    done = subprocess.run([program, "score", model, source, "--json", *reading], capture_output=True, text=True,
                          check=False)
    if done.returncode != 0:
        raise UsageError(f"{model} cannot be scored: {done.stderr.strip()}")
    found = json.loads(done.stdout)["objective"]
    return abs(found - row["objective"]) <= AGREES * row["objective"]


def update(program, units, book=BOOK):
    """Lowers the records by the fits in a folder of units. Returns lines that say what has changed."""
    records, best = read(book), {}
    for key, row, *rest in candidates(units):
        if row["objective"] < best.get(key, [{"objective": math.inf}])[0]["objective"]:
            best[key] = [row, *rest]
    lines = []
    for key, (row, model, source, reading) in sorted(best.items()):
        before = records.get(key, {"objective": math.inf})["objective"]
        if row["objective"] >= before:
            continue
        if not _confirmed(program, row, model, source, reading):
            lines.append(f"{key[0]}: E of {model} is not what its report says; the record stays")
            continue
        if math.isfinite(before):
            lines.append(f"{key[0]}, {key[3]}, {key[4]}: {before:.6g} is now {row['objective']:.6g} by {row['solver']}")
        records[key] = row
    book.parent.mkdir(exist_ok=True)
    tables.write(book, [records[key] for key in sorted(records)])
    return [f"{len(records)} records in {book}", *lines]
