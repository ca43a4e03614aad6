"""Diagnosis: see README.md beside this file."""
import json
import pathlib

from lab import corruptions, fits, merl, samples, tables
from lab.units import FOLDER, Unit

HERE = pathlib.Path(__file__).resolve().parent

# Faults of a table that `info` finds, by words of its notes.
TOLD = {"cosine": "--cosine=", "stray light": "light from elsewhere", "saturation": "saturated",
        "levels": "few levels", "noise": "scatter by", "repeated": "repeats the last",
        "tilt": "is tilted", "shadow": "own light", "outliers": "dead readings",
        "dark noise": "dark noise is"}

# Words of its notes on scattered samples, by fault of `told_of_samples`; on clean ones there are none.
TOLD_OF_SAMPLES = {"azimuth": "--azimuth=from_mirror", "relative": "add theta_i to it", "sign": "sign of an angle",
                   "elevation": "elevations", "radians": "in radians", "decibels": "as decibels are",
                   "scale": "--scale=0.01", "cosine_i": "--cosine=", "cosine_o": "--cosine=", "saturated": "saturated",
                   "marks": "to mark what was not measured", "negative": "are negative", "shadow": "beside others"}


def units(setting):
    return _of_tables(setting) + _of_samples(setting)


def _of_samples(setting):
    asked = setting.manifest["samples"]
    return [Unit(f"told/{source.name}", HERE / "told_of_samples",
                 (str(setting.program()), source.path, json.dumps(asked["faults"]), f"{FOLDER}/told.json",
                  *fits.words(setting.reading(source))), "told.json",
                 modules=(merl.__file__, samples.__file__), labels={"material": source.name, "samples": True})
            for source in setting.every(asked["every"])]


def _of_tables(setting):
    made = {}
    for of in setting.manifest["sets"]:
        for corruption in corruptions.of_kinds(of["kinds"]):
            for source in setting.every(of["every"]):
                unit = Unit(f"info/{source.name}/{fits.file_name(corruption)}", setting.program(),
                            ("info", source.path, "--json", "--threads=1",
                             *fits.words({**setting.reading(source),
                                          **corruptions.flags(corruption)})),
                            labels={"material": source.name, "corruption": corruption})
                made.setdefault(unit.key, unit)
    return list(made.values())


def tabulate(setting, results):
    """told: what `info` says of tables, a row for each. told_of_samples: on how many materials it says what is wrong,
    and something else. notes_of_samples: all that it says."""
    told, notes = [], []
    for result in results:
        if not result.folder:
            continue
        if "samples" in result.labels:
            notes += [{"material": result.labels["material"], **row, "notes": " | ".join(row["notes"])}
                      for row in json.loads((result.folder / "told.json").read_text())]
        else:
            said = " ".join(json.loads((result.folder / "stdout.txt").read_text())["notes"])
            told.append({**result.labels, **{name: int(words in said) for name, words in TOLD.items()}})
    return {"told": told, "told_of_samples": _counts(notes), "notes_of_samples": notes}


def _counts(notes):
    rows = []
    for (fault, strength, pattern), of in tables.groups(notes, "fault", "strength", "pattern").items():
        words = TOLD_OF_SAMPLES.get(fault)
        right = [words is not None and words in row["notes"] for row in of]
        rows.append({"fault": fault, "strength": strength, "pattern": pattern, "materials": len(of), "told": sum(right),
                     "only_other": sum(bool(row["notes"]) and not is_right for row, is_right in zip(of, right))})
    return rows


def _markdown_of_samples(rows):
    """A line a fault and strength: on how many materials it is told, by pattern."""
    patterns = list(dict.fromkeys(row["pattern"] for row in rows))
    lines = []
    for (fault, strength), of in tables.groups(rows, "fault", "strength").items():
        count = "only_other" if fault == "clean" else "told"
        shown = {row["pattern"]: f"{row[count]} of {row['materials']}" for row in of}
        share = sum(row[count] for row in of) / sum(row["materials"] for row in of)
        lines.append([fault, f"{strength:g}", *(shown.get(pattern, "") for pattern in patterns), f"{share:.1%}"])
    return tables.markdown(["fault", "strength", *patterns, "all"], lines)


def _figure(rows):
    """Draws the share of faults that are told, by their strength."""
    from lab import plots
    labels = {"scale": "values times", "saturated": "share of signals that is saturated"}
    faults = {fault: of for fault, of in tables.groups(rows, "fault").items() if fault in labels}
    figure, all_axes = plots.plt.subplots(1, len(faults), figsize=(4.5 * len(faults), 3.6), sharey=True, squeeze=False)
    axes = all_axes[0]
    for axis, (fault, of_fault) in zip(axes, faults.items()):
        for (pattern, of), colour in zip(tables.groups(of_fault, "pattern").items(), plots.SERIES):
            axis.semilogx([row["strength"] for row in of], [100 * row["told"] / row["materials"] for row in of], "o-",
                          color=colour, label=pattern)
        axis.set(xlabel=labels[fault], ylim=(-3, 103))
        axis.xaxis.set_major_locator(plots.matplotlib.ticker.LogLocator(subs=(1, 3)))
        axis.xaxis.set_major_formatter(plots.matplotlib.ticker.FormatStrFormatter("%g"))
        axis.xaxis.set_minor_formatter(plots.matplotlib.ticker.NullFormatter())
    axes[0].set(ylabel="told, % of the materials")
    axes[0].legend(loc="lower right")
    return figure


def draw(drawn, _):
    """A line a corruption: on how many materials each symptom is told."""
    lines = []
    for corruption, of in tables.groups(drawn["told"], "corruption").items():
        counts = [sum(row[name] for row in of) for name in TOLD]
        lines.append([corruption, str(len(of)), *(str(count or "") for count in counts)])
    rows = drawn["told_of_samples"]
    return {"told.md": tables.markdown(["corruption", "materials", *TOLD], lines),
            "told_of_samples.md": _markdown_of_samples(rows), "told_of_samples": _figure(rows)}
