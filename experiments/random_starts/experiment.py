"""The same random starts for all solvers: see README.md beside this file."""
import itertools
import json
import math
import statistics

import numpy
from lab import fits, stats, tables
from lab.units import Unit

FOUND, NEARLY = 0.01, 0.05  # E above the lowest of any start and solver, and of a search
SEARCHED = "searched"  # `multistart` with forty starts, which looks for the lowest E and is compared with none
CLOSE = 0.001
ALIKE = 0.001  # medians of E nearer than this are alike
# How far E is above the lowest of its material.
CLASSES = {(-1, FOUND): "up to 1 %", (FOUND, NEARLY): "1 to 5 %", (NEARLY, 0.2): "5 to 20 %", (0.2, math.inf): "more"}
# Factors of the analysis of variance. A start means something on one material only.
FACTORS = ("material", "solver", "seed")
PARTS = {"solver": [("solver",)], "solver by material": [("material", "solver")],
         "start": [("seed",), ("material", "seed")],
         "start by solver": [("solver", "seed"), ("material", "solver", "seed")]}


def units(setting):
    """Each solver of a set on each of its materials, from the first starts."""
    program = setting.program("thinned_fits")
    return [Unit(f"random_starts/{source.name}/{solver}", program,
                 (source.path, *fits.words({"solvers": solver, "starts": of["starts"],
                                            **setting.reading(source)})), labels={"material": source.name})
            for of in setting.manifest["sets"] for source in setting.every(of["every"]) for solver in of["solvers"]]


def tabulate(setting, results):
    """A row for each start; for each solver on a material how often it comes near the lowest E; and how what one sees
    goes with E."""
    starts = []
    for result in results:
        if result.folder:
            lines = (result.folder / "stdout.txt").read_text().splitlines()
            starts += [{**result.labels, **json.loads(line)} for line in lines]
    rows, seen, correlations, searched = [], [], [], []
    for material, all_of in tables.groups(starts, "material").items():
        of = [row for row in all_of if row["solver"] != SEARCHED]
        autos = [row for row in of if row["solver"] == "auto"]
        for row in all_of:
            if row["solver"] == SEARCHED:
                searched.append({
                    **{name: row[name] for name in ("material", "E", "tried", "came_there", "largest_g", "psnr_db",
                                                    "delta_e", "seconds")},
                    "lowest_other": min((other["E"] for other in of), default=None),
                    "auto": max((other["E"] for other in autos), default=None)})
        if not of:
            continue
        lowest = min(all_of, key=lambda row: row["E"])
        for row in of:
            row["excess"] = stats.excess(row["E"], lowest["E"])
        rows += [_row(material, solver, single) for solver, single in tables.groups(of, "solver").items()]
        correlations.append({"material": material, "fits": len(of), "rank_correlation": stats.rank_correlation(
            [row["E"] for row in of], [row["delta_e"] for row in of])})
        for (least, most), name in CLASSES.items():
            near = [row for row in of if least < row["excess"] <= most]
            if near:
                gains = [row["psnr_db"] - lowest["psnr_db"] for row in near]
                seen.append({"material": material, "E_above": name, "fits": len(near),
                             "lowest_by": lowest["solver"], "psnr_db_of_lowest": lowest["psnr_db"],
                             "delta_e_of_lowest": lowest["delta_e"],
                             "psnr_db_more": stats.median(gains), "least_psnr_db_more": min(gains),
                             "most_psnr_db_more": max(gains),
                             "delta_e_more": stats.median([row["delta_e"] - lowest["delta_e"] for row in near])})
    return {"starts": [row for row in starts if row["solver"] != SEARCHED], "solvers": rows, "seen": seen,
            "correlations": correlations, "searched": searched}


def _row(material, solver, of):
    excess = [row["excess"] for row in of]
    share = {limit: sum(value <= limit for value in excess) / len(of) for limit in (CLOSE, FOUND, NEARLY)}
    seconds = statistics.fmean(row["seconds"] for row in of)
    return {"material": material, "solver": solver, "starts": len(of), "within_0.1": share[CLOSE],
            "within_1": share[FOUND], "within_5": share[NEARLY], "median_E": statistics.median(row["E"] for row in of),
            "median_excess": stats.median(excess), "worst_excess": max(excess), "seconds": seconds,
            "seconds_to_1_by_restarts": seconds / share[FOUND] if share[FOUND] else math.inf,
            "seconds_to_5_by_restarts": seconds / share[NEARLY] if share[NEARLY] else math.inf,
            "raises": sum(row["raises"] for row in of)}


def _percent_with_interval(rows, key):
    """The mean over the materials, and its interval by bootstrap over them."""
    values = [100 * row[key] for row in rows]
    low, high = stats.bootstrap(values, statistics.fmean)
    return f"{statistics.fmean(values):.0f} [{low:.0f}, {high:.0f}]"


def _searched(searched):
    """A line a material: what a search finds beside the lowest E of all other fits, and by how much `auto` ends above
    the lower of both, from the worse of its starts."""
    lines = []
    for row in searched:
        if row.get("lowest_other") is None or row.get("auto") is None:
            continue
        lowest = min(row["E"], row["lowest_other"])
        above = round(100 * (row["E"] / row["lowest_other"] - 1), 2) + 0.0  # and not -0.00
        lines.append([row["material"], f"{row['E']:.6g}", f"{above:+.2f}",
                      f"{row['came_there']} of {row['tried']}", f"{row['largest_g']:.2g}",
                      f"{100 * stats.excess(row['auto'], lowest):.2f}"])
    return tables.markdown(["material", "E of the search", "over the lowest of all other fits, %",
                            "starts that came there", "largest G", "auto over the lower of both, %"], lines)


def _summary(rows):
    lines = []
    for solver, of in tables.groups(rows, "solver").items():
        lines.append([solver, str(len(of)), str(sum(row["starts"] for row in of)),
                      *(_percent_with_interval(of, key) for key in ("within_0.1", "within_1", "within_5")),
                      str(sum(row["within_1"] == 0 for row in of)),
                      tables.quartiles([100 * row["median_excess"] for row in of], ".1f"),
                      tables.quartiles([100 * row["worst_excess"] for row in of], ".1f"),
                      f"{100 * max(row['worst_excess'] for row in of):.0f}",
                      tables.quartiles([row["seconds"] for row in of], ".1f"),
                      tables.quartiles([row["seconds_to_1_by_restarts"] for row in of], ".0f"),
                      tables.quartiles([row["seconds_to_5_by_restarts"] for row in of], ".1f"),
                      str(sum(row["raises"] for row in of))])
    return tables.markdown(
        ["solver", "materials", "fits", "within 0.1 %, % of starts", "within 1 %", "within 5 %", "on none of them within 1 %",
         "E above it, median start, %", "worst start, %", "of all, %", "processor seconds a start",
         "until within 1 %, by restarts", "within 5 %", "E rose"], lines)


def _paired(rows):
    """Each two solvers: on how many materials the median start of one ends lower than that of the other."""
    return tables.paired({solver: {row["material"]: row["median_E"] for row in of}
                          for solver, of in tables.groups(rows, "solver").items()}, ALIKE)


def _seen(seen):
    """Visible effects of a higher E: a line a class, the median and quartiles of its materials."""
    lines = []
    for name in CLASSES.values():
        of = [row for row in seen if row["E_above"] == name]
        if of:
            lines.append([name, str(len(of)), str(sum(row["fits"] for row in of)),
                          tables.quartiles([row["psnr_db_more"] for row in of], "+.2f"),
                          f"{min(row['least_psnr_db_more'] for row in of):+.1f} to "
                          f"{max(row['most_psnr_db_more'] for row in of):+.1f}",
                          tables.quartiles([row["delta_e_more"] for row in of], "+.3f")])
    return tables.markdown(["E above the lowest", "materials", "fits", "PSNR, dB more than of the lowest E", "of all fits",
                            "mean ΔE more"], lines)


def _shares(starts):
    """Shares of the variance of log E, without that of the material, which depends on the choice of them; by all
    solvers that have had all starts, and without one of them each."""
    logs = [{**row, "log_E": math.log(max(row["E"], 1e-300))} for row in starts]
    cube, solvers = stats.crossed(logs, FACTORS, "solver", "log_E")
    if len(solvers) < 2:
        return ""
    lines = []
    for left_out in (None, *(solvers if len(solvers) > 2 else ())):
        kept = [number for number, solver in enumerate(solvers) if solver != left_out]

        def shares(materials, kept=kept):
            parts = stats.variance_shares(cube[materials][:, kept], FACTORS)
            left = 1 - parts.pop(("material",))
            return {name: 100 * sum(parts[of] for of in these) / left if left > 0 else math.nan
                    for name, these in PARTS.items()}
        everything = list(range(len(cube)))
        cells = []
        for name, share in shares(everything).items():
            low, high = stats.bootstrap(everything, lambda of, name=name: shares(of)[name], draws=500)
            cells.append(f"{share:.0f} [{low:.0f}, {high:.0f}]")
        lines.append([f"without {left_out}" if left_out else "all", *cells])
    return tables.markdown(["solvers", *(f"{name}, %" for name in PARTS)], lines)


def _figure(starts, rows):
    """Left how near starts end, a line a solver with its band; right how soon restarts have found the lowest E."""
    from lab import plots
    at = numpy.geomspace(1e-5, 10, 200)
    figure, (left, right) = plots.plt.subplots(1, 2, figsize=(11, 4.6))
    solvers = list(tables.groups(rows, "solver"))
    for solver, of in tables.groups(starts, "solver").items():
        each = [stats.data_profile([row["excess"] for row in single], at)
                for single in tables.groups(of, "material").values()]
        draws = numpy.random.default_rng(1).integers(len(each), size=(500, len(each)))
        low, high = numpy.quantile(numpy.array(each)[draws].mean(axis=1), (0.025, 0.975), axis=0)
        style = plots.solver_style(solver, solvers)
        left.plot(100 * at, 100 * numpy.mean(each, axis=0), label=solver, **style)
        left.fill_between(100 * at, 100 * low, 100 * high, color=style["color"], alpha=0.08, linewidth=0)
    left.set(xscale="log", ylim=(0, 100), xlabel="E above the lowest of any start and solver [%]",
             ylabel="starts that end so near [%], mean of the materials")
    plots.plain_numbers(left.xaxis)
    for solver, of in tables.groups(rows, "solver").items():
        times = [row["seconds_to_1_by_restarts"] for row in of]
        when = numpy.geomspace(0.3, 1000, 200)
        right.plot(when, 100 * stats.data_profile(times, when), **plots.solver_style(solver, solvers))
    right.set(xscale="log", ylim=(0, 100), xlabel="processor seconds that restarts take, expected",
              ylabel=f"materials brought within {100 * FOUND:g} % of the lowest E [%]")
    plots.plain_numbers(right.xaxis)
    plots.legend_above(figure, left)
    return figure


def draw(drawn, _):
    starts, rows = drawn.get("starts"), drawn["solvers"]  # all starts are bulk, which published tables lack
    products = {"searched.md": _searched(drawn["searched"])} if drawn.get("searched") else {}
    if rows:
        products |= {"summary.md": _summary(rows), "paired.md": _paired(rows), "seen.md": _seen(drawn["seen"])}
    if starts:
        products |= {"shares.md": _shares(starts), "ends": _figure(starts, rows)}
    return products
