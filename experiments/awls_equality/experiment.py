"""Fast and reference AWLS: see README.md beside this file."""
import math

from lab import fits, tables
from lab.units import Unit


def units(setting):
    settings = setting.manifest
    return [Unit(f"awls_equality/{source.name}", setting.program("awls_equality"),
                 (f"--sweeps={settings['sweeps']}", f"--stride={settings['stride']}",
                  f"--weighting={settings['weighting']}", *fits.words(setting.reading(source)),
                  source.path),
                 labels={"material": source.name})
            for source in setting.every(settings["every"])]


def tabulate(_, results):
    """The program fails where E differs by more than the limit: then the difference is infinite."""
    return {"sweeps": [{"material": result.labels["material"], **row} for result in results
                       for row in (tables.read(result.folder / "stdout.txt") if result.folder
                                   else [{"worst_relative_difference": math.inf}])]}


def draw(drawn, _):
    rows = drawn["sweeps"]
    header = ["material", "filter", "sweeps", "first E", "best E", "worst relative difference",
              "reference s/sweep", "awls s/sweep"]
    body = [[row["material"], "failed", *[""] * (len(header) - 2)]
            if row.get("filter") is None else
            [row["material"], f"{row['filter']:g}", str(row["sweeps"]), f"{row['first_E']:.6g}",
             f"{row['best_E']:.6g}", f"{row['worst_relative_difference']:.1e}",
             f"{row['literal_s_a_sweep']:.2f}", f"{row['awls_s_a_sweep']:.4f}"] for row in rows]
    worst = max(row["worst_relative_difference"] for row in rows)
    return {"sweeps.md": tables.markdown(header, body) + f"\nThe largest of all: {worst:.1e}.\n"}
