"""Single random starts, led by stiff tables or not: see README.md beside this file."""
import itertools
import json
import math
import statistics

import numpy

from lab import fits, stats, tables
from lab.units import Unit

WITHIN = 0.01  # of the lowest E that any start by any way has found: such a start has found it
NEAR = 0.05  # the same: such a start is good enough
SURE = 0.99  # the share of cases in which so many starts shall find it


def units(setting):
    """Each way, on each material, in batches of starts, so that a run can stop between them."""
    program = setting.program("softening")
    planned = {}
    for run in setting.manifest["sets"]:
        for corruption in run.get("corruptions", [""]):
            for batch in range(run["batches"]):
                for source in setting.every(run["every"]):
                    for way in run["ways"]:
                        labels = {"material": source.name, "way": way, "corruption": corruption}
                        flags = {"way": way, "starts": run["starts"],
                                 "first_seed": run["first_seed"] + batch * run["starts"], "corrupt": corruption,
                                 **setting.reading(source)}
                        unit = Unit(f"softening/{source.name}/{fits.file_name(way + corruption)}",
                                    program, (source.path, *fits.words(flags)), labels=labels)
                        planned[unit.key] = unit
    return list(planned.values())


def tabulate(setting, results):
    """A row for each start, and for each way on a material how often it finds the lowest E."""
    starts = []
    for result in results:
        if result.folder:
            machine = json.loads((result.folder / "unit.json").read_text())["machine"]["cpu"]
            lines = (result.folder / "stdout.txt").read_text().splitlines()
            starts += [{**result.labels, **json.loads(line), "machine": machine} for line in lines]
    named = setting.manifest["ways"]
    rows = []
    for (material, corruption), of in tables.groups(starts, "material", "corruption").items():
        lowest = min(row["E"] for row in of)
        by_way = tables.groups(of, "way")
        timed_on = set.intersection(*({row["machine"] for row in ways} for ways in by_way.values()))
        for way, single in by_way.items():
            excess = [stats.excess(row["E"], lowest) for row in single]
            rate, near = (sum(value <= limit for value in excess) / len(single)
                          for limit in (WITHIN, NEAR))
            # Of one machine, if one has gone all ways.
            seconds = statistics.fmean(row["seconds"] for row in single
                                       if not timed_on or row["machine"] in timed_on)
            rows.append({"material": material, "corruption": corruption, "way": way,
                         "name": named[way], "starts": len(single), "rate": rate, "near": near,
                         "median_excess": stats.median(excess), "worst_excess": max(excess),
                         "seconds": seconds, "sure_seconds": seconds * _starts_to_be_sure(rate),
                         "near_seconds": seconds * _starts_to_be_sure(near)})
    return {"starts": starts, "ways": rows}


def _starts_to_be_sure(rate):
    """How many starts find what each finds with that probability, in SURE of all cases."""
    if rate <= 0:
        return math.inf
    return max(1.0, math.log(1 - SURE) / math.log(1 - rate)) if rate < 1 else 1.0


def _line(name, rows):
    def percent(key):
        return tables.quartiles([100 * row[key] for row in rows], ".0f")
    return [name, str(len(rows)), str(sum(row["starts"] for row in rows)), percent("rate"),
            str(sum(row["rate"] == 0 for row in rows)), percent("near"),
            tables.quartiles([100 * row["median_excess"] for row in rows], ".1f"),
            tables.quartiles([100 * row["worst_excess"] for row in rows], ".1f"),
            f"{100 * max(row['worst_excess'] for row in rows):.0f}",
            tables.quartiles([row["seconds"] for row in rows], ".2f"),
            tables.quartiles([row["sure_seconds"] for row in rows], ".1f"),
            tables.quartiles([row["near_seconds"] for row in rows], ".1f")]


HEADER = ["materials", "starts", "find the lowest E, %", "never on", "within 5 % of it, %",
          "E above it, median start, %", "worst start, %", "of all, %", "processor seconds a start",
          "seconds to find it in 99 of 100 cases", "to be within 5 %"]


def _shared(rows):
    """Only the materials that every way has tried."""
    ways = {row["way"] for row in rows}
    return [row for row in rows
            if ways == {other["way"] for other in rows if other["material"] == row["material"]}]


def _summary(rows):
    clean = [row for row in rows if not row["corruption"]]
    lines = [_line(name, of) for name, of in tables.groups(_shared(clean), "name").items()]
    return tables.markdown(["way", *HEADER], lines)


def _corrupted(rows):
    bad = {row["material"] for row in rows if row["corruption"]}
    ways = {row["way"] for row in rows if row["corruption"]}
    chosen = [row for row in rows if row["material"] in bad and row["way"] in ways]
    lines = [[corruption or "none", *_line(name, of)] for (corruption, name), of in
             tables.groups(chosen, "corruption", "name").items()]
    return tables.markdown(["corruption", "way", *HEADER], sorted(lines, key=lambda line: line[0]))


def _profile(starts, ways):
    """The share of starts that end within each excess of the lowest E, mean over the materials."""
    lowest = {material: min(row["E"] for row in of)
              for material, of in tables.groups(starts, "material").items()}
    at = numpy.geomspace(1e-4, 1, 200)
    shared = {row["material"] for row in ways}
    for way, of in tables.groups(starts, "way").items():
        shares = [stats.data_profile([stats.excess(row["E"], lowest[material]) for row in single], at)
                  for material, single in tables.groups(of, "material").items() if material in shared]
        if shares:
            yield way, 100 * at, 100 * numpy.mean(shares, axis=0)


def _figure(starts, ways):
    """Left what starts end at, a curve a way; right how often they find the lowest E."""
    from lab import plots
    starts, ways = ([row for row in rows if not row["corruption"]] for rows in (starts, ways))
    ways = _shared(ways)
    name_of = {row["way"]: row["name"] for row in ways}
    style = dict(zip(name_of, itertools.product(("-", "--"), plots.SERIES)))
    mean = {material: statistics.fmean(row["rate"] for row in of)
            for material, of in tables.groups(ways, "material").items()}
    materials = sorted(mean, key=mean.get)
    figure, (left, right) = plots.plt.subplots(1, 2, figsize=(11, 2.2 + 0.2 * len(materials)))
    for way, at, shares in _profile(starts, ways):
        line, colour = style[way]
        left.plot(at, shares, line, color=colour, label=name_of[way])
    left.set(xscale="log", ylim=(0, 100), xlabel="E above the lowest that is known [%]",
             ylabel="starts that come so near [%], mean of the materials")
    plots.plain_numbers(left.xaxis)
    for row in ways:
        line, colour = style[row["way"]]
        right.plot(100 * row["rate"], materials.index(row["material"]), "o" if line == "-" else "s",
                   color=colour, markersize=5, alpha=0.8)
    right.set(yticks=range(len(materials)), yticklabels=materials, xlim=(-3, 103),
              xlabel=f"starts within {100 * WITHIN:g} % of the lowest E [%]")
    for axes in (left, right):
        axes.grid(color="0.92")
        axes.set_axisbelow(True)
    figure.tight_layout()
    plots.legend_above(figure, left, columns=3)
    return figure


def draw(drawn, _):
    rows = drawn["ways"]
    if not rows:
        return {}
    return {"summary.md": _summary(rows), "corrupted.md": _corrupted(rows),
            "rates": _figure(drawn["starts"], rows)}
