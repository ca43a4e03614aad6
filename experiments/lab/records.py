"""The book of records: the lowest E known of each measurement, weighting and form of model.

A record is never raised. A fit lowers it if `trilobe score` finds the same E of its model, which is deterministic:
the command, at the revision that the book names, makes the model again. `search` looks for lower ones by `multistart`.
"""
import functools
import itertools
import json
import math
import pathlib
import subprocess

from lab import UsageError, campaign, fits, materials, tables
from lab.units import FOLDER as TO_FILL
from lab.units import Unit

FOLDER = pathlib.Path(__file__).resolve().parents[1] / "records"
BOOK = FOLDER / "records.csv"

# Key of a record. The checksum is that of the measured values (`source_xxh128` of a report).
KEY = ("material", "source_xxh128", "valid_samples", "weighting", "model", "lobes", "parameters")
# Columns on a search: how many starts it tried, how many came as low as the record, in how many minima they ended, how
# many were random, the probability that a further one finds a new minimum, and how many ended more than 1 % below all
# that were not random, those of `auto` among these.
SEARCH = ("starts", "came_there", "minima", "random", "new_minimum", "random_lower")
LOWER = 0.01
# A model is degenerate if its largest G, in the scale of stored models, is above the first of these, or the least share
# of the light that a lobe reflects is below the second.
LARGE_G, NO_LIGHT = 1e4, 1e-4
# Flags that give a fit other data, or lower another E, than the measurement and the weighting say.
OTHER_DATA = ("corrupt", "missing", "dark_noise", "outliers", "extrapolated", "tilt", "cosine", "scale",
              "azimuth", "robust", "scene")
# Relative accuracy with which a model file's E can be found again.
AGREES = 1e-9
# A search has come to a record, by whatever fit, if its E is at most this share above.
SAME = 1e-3
STARTS = 40  # most starts that a search tries
# Flags that say what is fitted, which a search takes from the command of the record.
OF_PROBLEM = ("--max_angle=", "--weighting=", "--lobes=", "--model=")


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
    """Relative excess of an E over the record of this fit's measurement, weighting and form; None without a record."""
    least = lowest(report, material)
    return objective / least - 1 if 0 < least < math.inf else None


def columns(report, material):
    """Columns of a table for `refresh`: the key of the row's record, in one cell, and the record's E."""
    key = key_of(report, material)
    least = lowest(report, material)
    return {"record_of": " ".join(map(str, key[1:])), "record": least if math.isfinite(least) else None}


def refresh(rows, book=BOOK):
    """Sets `record` of the rows of `columns` to what the book says now, and `over_record`, how far their objective is
    above it. Returns whether one has changed."""
    of = {(key[0], " ".join(map(str, key[1:]))): row["objective"] for key, row in read(book).items()}
    changed = False
    for row in rows:
        if row.get("record_of"):
            now = of.get((row["material"], row["record_of"]), row.get("record"))
            above = row["objective"] / now - 1 if now else None
            changed |= now != row.get("record") or "over_record" not in row
            row |= {"record": now, "over_record": above}
    return changed


def _is_of_data(words):
    """Whether a fit by these flags is one of the measurement as it is."""
    names = {word.removeprefix("--").partition("=")[0] for word in words}
    return not names & set(OTHER_DATA) and "--noise=0" in words


def _shown(source, flags):
    """The command as others can type it: without this machine's folders."""
    left_out = ("--out=", "--noplots", "--convergence", "--noise=0", "--threads=")
    kept = [word for word in flags if not word.startswith(left_out)]
    return " ".join(["trilobe fit", pathlib.PurePath(source).name, *kept])


def _flags_of(report):
    """The flags of a fit that has left no command, by its report."""
    of_option = {"relative_decrease_tolerance": "tolerance", "g_filter_sigma": "g_filter"}
    flags = {of_option.get(name, name): value for name, value in report["options"]["given"].items()
             if value is not None}
    flags |= {"noise": 0, "solver": report["solver"], "init": report["init"], "seed": report["seed"],
              "raw": report["raw"], "max_angle": report["max_angle"], "weighting": report["weighting"],
              "lobes": report["lobes"]}
    return fits.words({name: f"{value:g}" if isinstance(value, float) else value for name, value in flags.items()})


def signs(folder, report):
    """Properties of the model in the folder of a fit, and whether it is degenerate."""
    G = json.loads((folder / "model.json").read_text())["G"]
    while G and isinstance(G[0], list):
        G = list(itertools.chain.from_iterable(G))
    largest = max(G, default=0.0)
    least = min((lobe["share"] for lobe in report["light"]["lobes"]), default=0.0) if report.get("light") else None
    degenerate = largest > LARGE_G or (least is not None and least < NO_LIGHT)
    return {"largest_G": float(f"{largest:.4g}"), "least_light": least and float(f"{least:.4g}"),
            "degenerate": int(degenerate),
            **{name: (report.get("appearance") or {}).get(name) for name in ("psnr_db", "mean_delta_e")}}


def candidates(root):
    """(key, row, folder of the model, source, flags that read the measurement) of each fit below a folder: units of
    experiments, and runs of `trilobe study`."""
    for file in sorted(root.rglob("report.json")):
        folder = file.parent
        if not (folder / "model.json").is_file() or any(part.startswith(".") for part in file.relative_to(root).parts):
            continue
        report = json.loads(file.read_text())
        if "source_xxh128" not in report or "objective" not in report:
            continue
        material = folder.parent.name
        if (folder / "unit.json").is_file():
            record = json.loads((folder / "unit.json").read_text())
            words, revision = record["command"], record["revision"]
            if len(words) < 3 or words[1] != "fit":
                continue
            source, flags = words[2], words[3:]
        else:
            source, flags, revision = report["source"], _flags_of(report), report["program"]
            material = materials.name_of(source)
        if (not _is_of_data(flags) or report.get("noise", 0) != 0 or report["prior"]
                or not math.isfinite(report["objective"])):
            continue
        key = key_of(report, material)
        reading = [word for word in flags if word.startswith(("--max_angle=", "--weighting="))]
        row = {**dict(zip(KEY, key)), "objective": report["objective"],
               "relative_objective": report["relative_objective"], "solver": report["solver"],
               "command": _shown(source, flags), "revision": revision}
        yield key, row, folder, source, reading


def _confirmed(program, row, model, source, reading):
    """Whether `trilobe score` finds the E of the report."""
    done = subprocess.run([program, "score", model, source, "--json", *reading], capture_output=True, text=True,
                          check=False)
    if done.returncode != 0:
        raise UsageError(f"{model} cannot be scored: {done.stderr.strip()}")
    found = json.loads(done.stdout)["objective"]
    return abs(found - row["objective"]) <= AGREES * row["objective"]


def write(records, path=BOOK):
    """Writes {key: row} as the book."""
    path.parent.mkdir(exist_ok=True)
    tables.write(path, [records[key] for key in sorted(records)])
    _published.cache_clear()


def update(program, units, book=BOOK, new=True):
    """Lowers the records by the fits below a folder. Returns lines that say what has changed.

    new: whether fits of what the book has no record of add one.
    """
    records, best = read(book), {}
    for key, row, *rest in candidates(units):
        if (new or key in records) and row["objective"] < best.get(key, [{"objective": math.inf}])[0]["objective"]:
            best[key] = [row, *rest]
    lines = []
    for key, (row, folder, source, reading) in sorted(best.items()):
        before = records.get(key, {"objective": math.inf})
        if row["objective"] >= before["objective"]:
            continue
        if not _confirmed(program, row, folder / "model.json", source, reading):
            lines.append(f"{key[0]}: E of {folder / 'model.json'} is not what its report says; the record stays")
            continue
        if math.isfinite(before["objective"]):
            lines.append(f"{key[0]}, {key[3]}, {key[4]}: {before['objective']:.6g} is now {row['objective']:.6g} by "
                         f"{row['solver']}")
        report = json.loads((folder / "report.json").read_text())
        seen = {name: before.get(name) for name in SEARCH}
        if seen["starts"] is not None and row["objective"] < before["objective"] / (1 + SAME):
            seen["came_there"] = 0  # the starts came to a higher minimum
        records[key] = {**row, **seen, **signs(folder, report)}
    if best:
        write(records, book)
    return [f"{len(records)} records in {book}", *lines]


# --- search ---------------------------------------------------------------------------------------


def search_of(row, source, program):
    """The unit that searches a row's problem."""
    problem = [word for word in row["command"].split() if word.startswith(OF_PROBLEM)]
    flags = fits.words({"noise": 0, "raw": True, "seed": 1, "solver": "multistart", "starts": STARTS, "threads": 1})
    return Unit(f"fit/{row['material']}/search-{fits.file_name(row['weighting'])}", program,
                ("fit", source.path, f"--out={TO_FILL}", "--noplots", *flags, *problem), "report.json",
                labels={"key": tuple(row[name] for name in KEY)})


def _note(report):
    """SEARCH of a search, but how many came to the record."""
    starts = report["starts"]
    random = [start for start in starts if "/" in start["name"]]
    least = min((start["objective"] for start in starts if start not in random), default=math.inf)
    n, w = len(random), len({start["minimum"] for start in random})
    return {"starts": len(starts), "minima": max((start["minimum"] for start in starts), default=0), "random": n,
            "new_minimum": float(f"{min(1.0, w * (w + 1) / (n * (n - 1))):.3g}") if n > 1 else 1.0,
            "random_lower": sum((1 + LOWER) * start["objective"] < least for start in random)}


def note(folder, key, book=BOOK):
    """Says in the book what a search has seen."""
    report = json.loads((folder / "report.json").read_text())
    records = read(book)
    row = records[key]
    there = report["objective"] <= (1 + SAME) * row["objective"]
    came = sum(start["minimum"] == 1 for start in report["starts"]) if there else 0
    records[key] = {**row, **_note(report), "came_there": came,
                    **(signs(folder, report) if there else {})}
    write(records, book)


def search(program, store, sources, book=BOOK, again=False):
    """Searches each record of the given materials that has not been searched, in the order of their importance, and
    lowers it by what it finds. What is searched stays when this is stopped. Returns the lines of failures."""
    source_of = {source.name: source for source in sources}
    first = {source.name for source in materials.every(sources, 7)}  # those of most experiments

    def importance(row):
        return row["weighting"] != "appearance", row["material"] not in first, row["material"], row["weighting"]
    rows = [row for row in read(book).values() if row["material"] in source_of
            and (again or row.get("starts") is None)]
    failures = []
    for row in sorted(rows, key=importance):
        if row["material"] not in source_of:
            continue
        unit = search_of(row, source_of[row["material"]], program)
        failed = campaign.run(store, [unit], again)
        failures += failed
        if failed:
            continue
        folder, key = store.folder(unit), unit.labels["key"]
        found = key_of(json.loads((folder / "report.json").read_text()), row["material"])
        if found != key:
            failures.append(f"{row['material']}: this file has the checksum {found[1]}, that in {book} {key[1]}")
            del source_of[row["material"]]  # nor are its other records of this file
            continue
        for line in update(program, folder, book)[1:]:
            print(line, flush=True)
        note(folder, key, book)
    return failures
