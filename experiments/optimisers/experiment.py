"""Other people's optimisers: see README.md beside this file."""
import json
import math
import pathlib

import numpy

from lab import UsageError, fits, stats, tables
from lab.fits import Fit
from lab.units import FOLDER, Unit

HERE = pathlib.Path(__file__).parent
OURS = "trilobe"
ONE_START = "varpro"  # our solver with one start, like theirs: auto compares several
# Derivatives of E that a method takes: the panels of the picture.
FIRST, SECOND = "gradients", "second derivatives"
METHODS = {  # library, what it takes
    "lbfgsb": ("SciPy", FIRST), "lbfgsb_log": ("SciPy", FIRST), "tnc": ("SciPy", FIRST),
    "mma": ("NLopt", FIRST), "ccsaq": ("NLopt", FIRST), "tnewton": ("NLopt", FIRST),
    "slsqp": ("NLopt", FIRST), "ipopt_lbfgs": ("Ipopt", FIRST), "adam": ("Adam", FIRST),
    "trf": ("SciPy", SECOND), "dogbox": ("SciPy", SECOND), "ipopt": ("Ipopt", SECOND),
    "ipopt_gauss_newton": ("Ipopt", SECOND)}
SHARES = (0.2, 0.4, 1)  # shares of the seconds after which E is compared
TARGETS = (0.1, 0.01, 0.001)
ALIKE = 0.001
POINTS = 40  # points per curve


def units(setting):
    package = setting.build / "python"
    modules = sorted(package.glob("trilobe/_*.so"))
    if not modules:
        raise UsageError(f"{package} has no package trilobe: scripts/check_python.sh builds it")
    program = HERE / "minimise"
    theirs = []
    for source in setting.every(setting.manifest["runs"][0].get("every", 1)):
        reading = {"missing": setting.manifest["missing"], **setting.reading(source)}
        for method in setting.manifest["methods"]:
            theirs.append(Unit(
                f"minimise/{source.name}/{method}", program,
                (str(package.resolve()), source.path, method, str(setting.manifest["seconds"]), FOLDER,
                 *(f"{name}={json.dumps(value)}" for name, value in sorted(reading.items()))),
                "model.json", modules=(HERE / "counted.py", HERE / "methods.py", *modules),
                labels={"material": source.name, "solver": method, "run": ""}))
    return fits.planned(setting) + theirs


# --- tables ---------------------------------------------------------------------------------------


def _trace(result, setting):
    """([seconds from the start of the search], [E], evaluations until the lowest, why it stopped)."""
    if result.labels["solver"] in METHODS:
        rows = tables.read(result.folder / "trace.csv")
        stopped = json.loads((result.folder / "run.json").read_text())["stopped"]
        return ([row["seconds"] for row in rows], [row["objective"] for row in rows], rows[-1]["evaluations"], stopped)
    fit = Fit(result.folder, fits.clock(setting))
    return ([row["clock"] - fit.before for row in fit.trace], [row["objective"] for row in fit.trace], None,
            fit.report["stop_reason"])


def tabulate(setting, results):
    traces = {result.unit.key: _trace(result, setting) for result in results if result.folder}
    seconds = setting.manifest["seconds"]
    when = [share * seconds for share in SHARES]
    curve_at = numpy.geomspace(seconds / 50, seconds, POINTS)
    at = {key: stats.value_at(times, stats.best_so_far(values), [*when, *curve_at])
          for key, (times, values, _, _) in traces.items()}
    least, starts = {}, {}
    for result in results:
        if result.folder:
            name = result.labels["material"]
            least[name] = min(least.get(name, math.inf), at[result.unit.key][len(when) - 1])
            starts.setdefault(name, set()).add(traces[result.unit.key][1][0])
    runs, curves = [], []
    for result in results:
        name, solver = result.labels["material"], result.labels["solver"]
        row = {"material": name, "solver": solver, "library": METHODS.get(solver, (OURS,))[0]}
        if not result.folder:
            runs.append({**row, "excess": math.inf, "stopped": "missing"})
            continue
        _, values, evaluations, stopped = traces[result.unit.key]
        E = at[result.unit.key]
        runs.append({**row, "start": values[0], "objective": E[len(when) - 1],
                     "excess": stats.excess(E[len(when) - 1], least[name]),
                     **{f"excess_at_{100 * share:.0f}_percent": stats.excess(E[k], least[name]) for k, share in enumerate(SHARES[:-1])},
                     "evaluations": evaluations, "stopped": stopped})
        curves += [{"material": name, "solver": solver, "seconds": float(f"{t:.4g}"),
                    "excess": float(f"{stats.excess(value, least[name]):.4g}")}
                   for t, value in zip(curve_at, E[len(when):])]
    return {"runs": runs, "curves": curves}


# --- texts and pictures ---------------------------------------------------------------------------


def _percent(value):
    return f"{100 * value:.3g}" if math.isfinite(value) else "–"


def _order(rows):
    """Solvers by how far they are above the lowest E, in the median."""
    return sorted(tables.groups(rows, "solver").items(),
                  key=lambda pair: stats.median([row["excess"] for row in pair[1]]))


def _summary(rows, columns):
    lines = []
    for solver, of in _order(rows):
        excess = [row["excess"] for row in of]
        evaluations = [row["evaluations"] for row in of if row.get("evaluations") is not None]
        lines.append([solver, of[0]["library"], *(str(sum(e <= target for e in excess)) for target in TARGETS),
                      *(_percent(stats.median([math.inf if row.get(column) is None else row[column] for row in of]))
                        for column in columns),
                      _percent(max(excess)), f"{stats.median(evaluations):.0f}" if evaluations else ""])
    return tables.markdown(
        ["solver", "library", *(f"within {100 * target:g} %" for target in TARGETS),
         *(f"excess after {100 * share:.0f} % of the time, %" for share in SHARES), "largest, %", "evaluations"], lines)


def _paired(rows):
    """Our solver of one start against each optimiser of another library."""
    ends = {(row["solver"], row["material"]): row.get("objective") or math.inf for row in rows}
    names = sorted({row["material"] for row in rows})
    lines = []
    for solver, _ in _order(rows):
        if solver in METHODS:
            lower, higher, p = stats.sign_test([ends[ONE_START, name] for name in names],
                                               [ends[solver, name] for name in names], ALIKE)
            lines.append([solver, str(lower), str(higher), str(len(names) - lower - higher), f"{p:.2g}"])
    return tables.markdown(["solver", f"{ONE_START} lower", "it lower", "alike", "p"], lines)


def _figure(curves, rows):
    from lab import plots
    coloured = plots.SERIES[:6]  # the others are ours
    of = tables.groups(curves, "solver")
    figure, both = plots.plt.subplots(1, 2, figsize=(11, 5), sharey=True)
    ours = [solver for solver in of if solver not in METHODS]
    for axes, kind in zip(both, (FIRST, SECOND)):
        theirs = [solver for solver, _ in _order(rows) if METHODS.get(solver, ("", ""))[1] == kind]
        for solver in ours + theirs:
            times = sorted({row["seconds"] for row in of[solver]})
            middle = [100 * stats.median([row["excess"] for row in of[solver] if row["seconds"] == t]) for t in times]
            if solver in METHODS:
                again, k = divmod(theirs.index(solver), len(coloured))
                style = {"color": coloured[k], "linewidth": 1.8, "linestyle": ("-", "--", ":")[again]}
            else:
                style = {"color": plots.BLACK if solver == ONE_START else plots.GREY,
                         "linewidth": 2.6 if solver == ONE_START else 0.9}
            axes.plot(times, numpy.maximum(middle, 0.01), label=solver, **style)
        axes.set(xscale="log", yscale="log", xlabel="seconds of one processor",
                 title=f"Optimisers that take {kind}, and ours")
        axes.set_ylim(0.01, 1000)
        plots.plain_numbers(axes.xaxis)
        plots.plain_numbers(axes.yaxis)
        plots.label_ends(axes, spacing=0.042)
    both[0].set_ylabel("E over the lowest (%), median; 0.01 or less at the bottom")
    return figure


def draw(drawn, _):
    rows = drawn["runs"]
    columns = [*(f"excess_at_{100 * share:.0f}_percent" for share in SHARES[:-1]), "excess"]
    products = {"summary.md": _summary(rows, columns), "paired.md": _paired(rows)}
    if drawn["curves"]:
        products["curves"] = _figure(drawn["curves"], rows)
    return products
