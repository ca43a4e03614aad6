"""Corruption by solver by weighting: see README.md beside this file."""
import itertools
import json

import numpy
from lab import corruptions, fits, stats, tables
from lab.corruptions import CLEAN, kind_of, strength_of
from lab.units import Unit

ALIKE = 0.01  # relative, in 10^(dB / 20)
FACTORS = ("material", "corruption", "solver", "weighting")


def units(setting):
    """Each corrupted table once for each run of the manifest, which fits it by all of its solvers and weightings."""
    manifest, program = setting.manifest, setting.program("thinned_fits")
    made = []
    for source, corruption, run in itertools.product(
            setting.every(manifest["every"]), corruptions.of_kinds(manifest["corruptions"]), manifest["runs"]):
        flags = {"init": "analytic", **{name: ",".join(of) for name, of in run.items()},
                 **corruptions.flags(corruption), **setting.reading(source)}
        made.append(Unit(f"solver_robustness/{source.name}/{fits.file_name(corruption)}-{run['solvers'][0]}", program,
                         (source.path, *fits.words(flags)),
                         labels={"material": source.name, "corruption": corruption}))
    return made


def tabulate(setting, results):
    """A row for each fit, with what the sphere has lost against the clean fit by the same solver and weighting."""
    rows = []
    for result in results:
        if result.folder:
            lines = (result.folder / "stdout.txt").read_text().splitlines()
            rows += [{**result.labels, **{name: value for name, value in json.loads(line).items() if name != "seed"}}
                     for line in lines]
    clean = {(row["material"], row["solver"], row["weighting"]): row["psnr_db"] for row in rows
             if row["corruption"] == CLEAN}
    for row in rows:
        row["lost_db"] = clean.get((row["material"], row["solver"], row["weighting"]), float("nan")) - row["psnr_db"]
    return {"fits": rows}


def _lost(rows, by, where):
    """Losses by kind and strength, a column for each value of `by`; the first line has the PSNR of clean fits."""
    columns = list(dict.fromkeys(row[by] for row in rows if where(row)))
    lines = []
    for corruption, of in tables.groups([row for row in rows if where(row)], "corruption").items():
        key = "psnr_db" if corruption == CLEAN else "lost_db"
        lines.append([kind_of(corruption), strength_of(corruption),
                      *(tables.quartiles([row[key] for row in of if row[by] == column], ".1f") for column in columns)])
    return tables.markdown(["kind", "strength", *columns], lines)


def _paired(rows, by, where):
    """Each two values of `by` on the same corrupted tables: which sphere is nearer to the clean measurement."""
    keys = [name for name in FACTORS if name != by]
    of = {value: {tuple(row[name] for name in keys): row for row in single} for value, single in tables.groups(
        [row for row in rows if where(row) and row["corruption"] != CLEAN], by).items()}
    lines = []
    for one, other in itertools.combinations(of, 2):
        both = sorted(of[one].keys() & of[other].keys())
        # Ratios, so that the tolerance is one of decibels.
        lower, higher, _ = stats.sign_test(*([10 ** (-of[value][key]["psnr_db"] / 20) for key in both]
                                             for value in (one, other)), ALIKE)
        gain = [of[one][key]["psnr_db"] - of[other][key]["psnr_db"] for key in both]
        by_material = {}
        for key, value in zip(both, gain):
            by_material.setdefault(key[0], []).append(value)
        low, high = stats.bootstrap(list(by_material), lambda names, of=by_material: float(
            numpy.mean([value for name in names for value in of[name]])))
        lines.append([one, other, str(lower), str(higher), str(len(both) - lower - higher),
                      f"{numpy.mean(gain):+.2f} [{low:+.2f}, {high:+.2f}]"])
    return tables.markdown([by, "other", "better", "worse", "alike", "dB better, mean"], lines)


def _shares(rows):
    """Shares of the variance of the PSNR, over the solvers that have gone through all."""
    cube, solvers = stats.crossed(rows, FACTORS, "solver", "psnr_db")
    if not solvers:
        return ""
    shares = stats.variance_shares(cube, FACTORS)
    return tables.markdown(["part", "percent"],
                           [[" by ".join(of), f"{100 * share:.1f}"] for of, share in
                            sorted(shares.items(), key=lambda item: -item[1]) if share >= 0.0005])


def _figure(rows):
    """The PSNR by strength: a row of panels for solvers by the default weighting, one for weightings by one solver."""
    from lab import plots
    kinds = list(dict.fromkeys(kind_of(row["corruption"]) for row in rows if row["corruption"] != CLEAN))
    default, solver = rows[0]["weighting"], rows[0]["solver"]
    panels = [("solver", [row for row in rows if row["weighting"] == default]),
              ("weighting", [row for row in rows if row["solver"] == solver])]
    figure, axes = plots.plt.subplots(2, len(kinds), figsize=(2.2 * len(kinds) + 1.6, 5.4), sharey=True, squeeze=False)
    for line, (by, chosen) in zip(axes, panels):
        for panel, kind in zip(line, kinds):
            of_kind = [row for row in chosen if kind_of(row["corruption"]) in (CLEAN, kind)]
            names = list(dict.fromkeys(row["corruption"] for row in of_kind))
            for number, (value, of) in enumerate(tables.groups(of_kind, by).items()):
                style = (plots.solver_style(value) if by == "solver"
                         else {"color": plots.SERIES[number], "linestyle": "-"})
                panel.plot(range(len(names)), [numpy.mean([row["psnr_db"] for row in of if row["corruption"] == name])
                                               for name in names], marker="o", markersize=3, label=value, **style)
            panel.set(title=kind, xticks=range(len(names)))
            panel.set_xticklabels(["0", *(strength_of(name) for name in names[1:])])
        line[0].set_ylabel(f"PSNR [dB], by {by}")
        line[-1].legend(loc="lower left", fontsize=8)
    figure.supxlabel("strength")
    return figure


def draw(drawn, _):
    rows = drawn["fits"]
    if not rows:
        return {}
    default, solver = rows[0]["weighting"], rows[0]["solver"]
    return {"solvers.md": _lost(rows, "solver", lambda row: row["weighting"] == default),
            "weightings.md": _lost(rows, "weighting", lambda row: row["solver"] == solver),
            "paired.md": _paired(rows, "solver", lambda row: row["weighting"] == default)
            + "\n" + _paired(rows, "weighting", lambda row: row["solver"] == solver),
            "shares.md": _shares(rows), "strengths": _figure(rows)}
