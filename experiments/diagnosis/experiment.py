"""Diagnosis: see README.md beside this file."""
import json

from lab import corruptions, fits, tables
from lab.units import Unit

# What `info` says of a table, by words of its notes.
TOLD = {"cosine": "--cosine=", "stray light": "light from elsewhere", "saturation": "saturated",
        "levels": "few levels", "noise": "scatter by", "repeated": "repeats the last",
        "tilt": "is tilted", "shadow": "own light", "outliers": "dead readings",
        "dark noise": "dark noise is"}


def units(setting):
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
    """told: what `info` says, a row for each."""
    rows = []
    for result in results:
        if result.folder:
            notes = " ".join(json.loads((result.folder / "stdout.txt").read_text())["notes"])
            rows.append({**result.labels,
                         **{name: int(words in notes) for name, words in TOLD.items()}})
    return {"told": rows}


def draw(drawn, _):
    """A line a corruption: on how many materials each symptom is told."""
    lines = []
    for corruption, of in tables.groups(drawn["told"], "corruption").items():
        counts = [sum(row[name] for row in of) for name in TOLD]
        lines.append([corruption, str(len(of)), *(str(count or "") for count in counts)])
    return {"told.md": tables.markdown(["corruption", "materials", *TOLD], lines)}
