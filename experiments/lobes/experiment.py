"""Stability of the lobes: see README.md beside this file."""
import itertools
import json
import math
import statistics

import numpy

from lab import fits, lobes, records, stats, tables
from lab.fits import Fit
from lab.units import FOLDER, Product, Unit

SUCCESS = 0.01  # relative to the lowest E: at most so much above is as good
COLLAPSED = 1e-4  # share of the reflected light, less than which is no lobe
COPY = 0.99  # how alike two lobes of one model are
BLOWN_UP = 2.0  # times what the reference reflects
SAME = 0.9  # agreement of lobes that are the same
STABLE = 0.9  # share of a material's runs that have the same lobes
STARTS, CLEAN, NOISE = "starts", "noise-free", "noise"


def _thinned(setting):
    """Fits to fewer samples: from random starts, and from the given one to noisy copies and without noise."""
    asked = setting.manifest["thinned"]
    if asked is None:
        return []
    program, step = setting.program("thinned_fits"), asked["starts_a_unit"]

    def unit(source, solver, name, run, flags, **labels):
        given = {"solvers": solver, "lights": asked["lights"], "models": FOLDER, **asked["solvers"][solver],
                 **setting.reading(source), **flags}
        return Unit(f"lobes/{source.name}/{solver}-{name}", program, (source.path, *fits.words(given)),
                    labels={"material": source.name, "solver": solver, "run": run, **labels})
    sources, solvers, noise, units = setting.every(asked["every"]), asked["solvers"], asked["noise"], []
    for first, source, solver in itertools.product(range(1, asked["starts"] + 1, step), sources, solvers):
        units.append(unit(source, solver, f"from-{first}", STARTS,
                          {"init": "random", "first_start": first,
                           "starts": min(step, asked["starts"] + 1 - first)}))
    for source, solver in itertools.product(sources, solvers):
        units.append(unit(source, solver, "clean", CLEAN, {"init": "analytic"}))
        units += [unit(source, solver, f"noise-{draw}", NOISE,
                       {"init": "analytic", "corrupt": f"noise:{noise['sigma']}", "data_seed": draw}, seed=draw)
                  for draw in range(1, noise["draws"] + 1)]
    return units


def units(setting):
    """The fits, and the spectra of J at those of the first seed."""
    fitted = fits.planned(setting)
    source_of = {source.name: source for source in setting.sources}

    def arguments(unit):
        source = source_of[unit.labels["material"]]
        return (Product(unit, "model.json"), source.path, *fits.words(setting.reading(source)))
    spectra = [
        Unit(f"spectrum/{unit.labels['material']}/{unit.labels['solver']}",
             setting.program("spectrum"), arguments(unit),
             labels={**unit.labels, "run": "spectrum"})
        for unit in fitted if unit.labels["run"] == "lobes"
        and unit.labels["seed"] == min(of.labels["seed"] for of in fitted)]
    return _thinned(setting) + fitted + spectra


# --- tables ---------------------------------------------------------------------------------------


class _Run:
    """A fit: what is said of it, and where its model lies."""

    def __init__(self, labels, path, told):
        self.labels, self.path, self.told = labels, path, told
        self.objective = told["objective"]
        self.lobes = json.loads(path.read_text())["lobes"]
        self.match = None  # with the reference
        self.own_agreement = None  # with its solver's run of the lowest E

    @property
    def group(self):
        """Runs whose lobes are compared: each noisy fit with its solver's own without noise."""
        run, solver = self.labels["run"], self.labels["solver"]
        noise = run in (CLEAN, NOISE)
        return self.labels["material"], NOISE if noise else run, self.lobes, solver if noise else None


def _runs_of(result, clock):
    """The runs of a unit: one of `trilobe fit`, many of thinned_fits."""
    if (result.folder / "report.json").exists():
        fit = Fit(result.folder, clock)
        diagnosis = fit.report["diagnosis"] or {}
        return [_Run(result.labels, result.folder / "model.json", {
            "objective": fit.report["objective"], "seconds": fit.solved,
            "psnr_db": (fit.report.get("appearance") or {}).get("psnr_db"),
            "over_record": records.excess(fit.report["objective"], fit.report, result.labels["material"]),
            **{name: fit.report[name] for name in ("stop_reason", "iterations")},
            **{name: diagnosis.get(name) for name in ("optimality", "rank", "condition", "unresolved")}})]
    runs = []
    for line in (result.folder / "stdout.txt").read_text().splitlines():
        told = json.loads(line)
        runs.append(_Run({**result.labels, "seed": result.labels.get("seed", told["seed"])},
                         result.folder / f"{told['solver']}-{told['seed']}.json",
                         {"objective": told["E"], **{name: told[name] for name in (
                             "seconds", "psnr_db", "stop_reason", "iterations", "optimality")}}))
    return runs


def _lowest(runs):
    return min(runs, key=lambda run: run.objective)


def _compare(setting, runs):
    """Matches each run with the reference of its group. Returns {group: reference}."""
    program, references = setting.program("match_lobes"), {}
    groups = {}
    for run in runs:
        groups.setdefault(run.group, []).append(run)
    for group, of in groups.items():
        clean = [run for run in of if run.labels["run"] == CLEAN]
        if group[1] == NOISE and not clean:
            continue
        references[group] = reference = _lowest(clean or of)
        for run, match in zip(of, lobes.matches(program, reference.path, [run.path for run in of])):
            run.match = match
        if group[1] == NOISE:
            continue
        for solver in {run.labels["solver"] for run in of}:
            own = [run for run in of if run.labels["solver"] == solver]
            best = _lowest(own)
            for run, match in zip(own, lobes.matches(program, best.path, [run.path for run in own])):
                run.own_agreement = None if run is best else match["agreement"]
    return references


def _row(run, reference):
    light = numpy.array(run.match["light"])
    total = float(light.sum())
    shares = light / total if total > 0 else light
    told, labels = run.told, run.labels
    return {
        "run": labels["run"], "material": labels["material"], "solver": labels["solver"],
        "lobes": run.lobes, "seed": labels["seed"], "objective": run.objective,
        "over_record": told.get("over_record"),
        # Under noise E is mostly noise, which a model must not follow.
        "excess": stats.excess(run.objective, reference.objective) if run.group[1] != NOISE else None,
        "optimality": told["optimality"], "stop_reason": told["stop_reason"], "iterations": told["iterations"],
        "seconds": told["seconds"], "reference": int(run is reference), "agreement": run.match["agreement"],
        "own_agreement": run.own_agreement, "least_match": min(run.match["match"], default=1.0),
        "collapsed": int((shares[:-1] < COLLAPSED).any()), "likest_pair": run.match["likest_pair"],
        "albedo": total, "albedo_over_reference": total / sum(reference.match["light"]),
        **{f"share_{k + 1}": float(shares[m]) for k, m in enumerate(run.match["lobe"])},
        "share_diffuse": float(shares[-1]), "psnr_db": told["psnr_db"],
        **{name: told.get(name) for name in ("rank", "condition", "unresolved")}}


def _part_name(part, order):
    """"D1" of the program, tables counted from 0, for readers: lobes as the reference has them."""
    kind, index = part[0], part[1:]
    if kind == "d":
        return "d"
    if kind == "F":
        return f"F of {('red', 'green', 'blue')[int(index)]}"
    return f"{kind} of lobe {order.index(int(index)) + 1}"


def _weakest(spectrum, order):
    """A line for each of the weakest directions: what it moves."""
    rows = []
    for number, direction in enumerate(spectrum["weakest"], 1):
        shares = sorted(((share, part) for part, share in direction["shares"].items()),
                        reverse=True)
        rows.append({"number": number, "relative_singular_value":
                     direction["singular_value"] / spectrum["singular_values"][0],
                     "moves": ", ".join(f"{_part_name(part, order)} {100 * share:.0f} %"
                                        for share, part in shares[:3] if share >= 0.01),
                     "largest_in": _part_name(direction["largest"]["part"], order),
                     "entry": direction["largest"]["entry"]})
    return rows


def tabulate(setting, results):
    clock = fits.clock(setting)
    runs = [run for result in results if result.folder and result.labels["run"] != "spectrum"
            for run in _runs_of(result, clock)]
    references = _compare(setting, runs)
    compared = [run for run in runs if run.group in references]
    rows = [_row(run, references[run.group]) for run in compared]
    order_of = {run.path.parent: run.match["lobe"] for run in compared if run.labels["run"] == "lobes"}
    folder_of = {result.unit.key: result.folder for result in results}
    spectra, weakest = [], []
    for result in results:
        if not result.folder or result.labels["run"] != "spectrum":
            continue
        spectrum = json.loads((result.folder / "stdout.txt").read_text())
        order = order_of[folder_of[result.unit.needs[0].key]]
        labels = {"material": result.labels["material"], "lobes": len(order)}
        values = spectrum["singular_values"]
        spectra += [{**labels, "number": k + 1, "relative_singular_value": value / values[0],
                     "columns": spectrum["columns"],
                     "gauge_directions": spectrum["gauge_directions"]}
                    for k, value in enumerate(values)]
        weakest += [{**labels, **row} for row in _weakest(spectrum, order)]
    missing = [{**{key: result.labels[key] for key in ("run", "material", "solver")}, "unit": result.unit.path}
               for result in results if not result.folder]
    return {"runs": rows, "spectra": spectra, "weakest": weakest, "missing": missing}


# --- pictures -------------------------------------------------------------------------------------


def _shares_figure(rows):
    """Draws the light that each lobe reflects, a dot a run."""
    from lab import plots
    by_material = tables.groups(rows, "material")
    solvers = list(dict.fromkeys(row["solver"] for row in rows))
    count = max(row["lobes"] for row in rows)
    columns = [*(f"share_{k + 1}" for k in range(count)), "share_diffuse"]
    names = [*(f"lobe {k + 1}" for k in range(count)), "diffuse"]
    across = min(5, len(by_material))
    lines = math.ceil(len(by_material) / across)
    figure, panels = plots.plt.subplots(lines, across, sharey=True, squeeze=False,
                                        figsize=(2.9 * across + 1, 3.2 * lines + 0.6))
    for axes in panels.flat[len(by_material):]:
        axes.set_axis_off()
    for axes, (material, of_material) in zip(panels.flat, by_material.items()):
        for i, solver in enumerate(solvers):
            of = [row for row in of_material if row["solver"] == solver]
            for j, column in enumerate(columns):
                place = j + 0.8 * ((i + 0.5) / len(solvers) - 0.5)
                spread = 0.5 / len(solvers) * (numpy.arange(len(of)) / max(1, len(of) - 1) - 0.5)
                axes.plot(place + spread, [100 * max(row[column], 1e-6) for row in of], "o",
                          markersize=3, color=plots.solver_style(solver, solvers)["color"],
                          label=solver if j == 0 else "_")
        axes.axhline(100 * COLLAPSED, color=plots.GREY, linewidth=1)
        axes.set(yscale="log", ylim=(5e-5, 150), title=material)
        axes.set_xticks(range(len(names)), names, fontsize=9)
        axes.grid(visible=False, axis="x")
        plots.plain_numbers(axes.yaxis)
    for axes in panels[:, 0]:
        axes.set_ylabel("share of the reflected light (%)")
    panels[0, 0].text(0.02, 70 * COLLAPSED, "collapsed", fontsize=8, color="#555555",
                      transform=panels[0, 0].get_yaxis_transform(), va="top")
    plots.legend_above(figure, panels[0, 0])
    return figure


def _stability_figure(rows):
    """A line a material and solver: the agreement of the lobes, E and what one sees of each run."""
    from lab import plots
    solvers = list(dict.fromkeys(row["solver"] for row in rows))
    by_material = tables.groups(rows, "material")
    names = sorted(by_material, key=lambda name: stats.median([row["agreement"] for row in by_material[name]]))
    figure, panels = plots.plt.subplots(1, 3, sharey=True, figsize=(13, (0.2 + 0.17 * len(solvers)) * len(names) + 1.4))
    for y, name in enumerate(names):
        for k, solver in enumerate(solvers):
            of = [row for row in by_material[name] if row["solver"] == solver]
            heights = y + 0.8 * (0.5 - (k + 0.5) / len(solvers)) + 0.12 * numpy.linspace(-1, 1, len(of))
            style = {"color": plots.solver_style(solver, solvers)["color"], "markersize": 3.5, "alpha": 0.7,
                     "linestyle": "", "marker": "o", "label": solver if y == 0 else "_"}
            panels[0].plot([row["agreement"] for row in of], heights, **style)
            panels[1].plot([100 * max(row["excess"], 1e-6) for row in of], heights, **style)
            panels[2].plot([row["psnr_db"] for row in of], heights, **style)
    panels[0].axvline(SAME, color=plots.GREY, linewidth=1)
    panels[0].set(xlim=(-0.03, 1.03), xlabel="agreement of the lobes with those of the lowest run")
    panels[0].set_yticks(range(len(names)), names)
    panels[1].set(xscale="log", xlabel="E above the lowest (%)")
    plots.plain_numbers(panels[1].xaxis)
    panels[2].set(xlabel="PSNR of the sphere (dB)")
    for axes in panels:
        axes.grid(visible=False, axis="y")
    plots.legend_above(figure, panels[0])
    return figure


def _lobes_figure(rows):
    """E, and how far runs agree, against the number of lobes."""
    from lab import plots
    figure, panels = plots.plt.subplots(1, 3, figsize=(13.5, 4.4))
    by_material = tables.groups(rows, "material")
    for k, (material, of_material) in enumerate(by_material.items()):
        of_count = dict(sorted(tables.groups(of_material, "lobes").items()))
        best = {count: min(row["objective"] for row in of) for count, of in of_count.items()}
        most = best[min(best)]
        style = {"color": plots.SERIES[k % len(plots.SERIES)], "marker": "o", "label": material}
        panels[0].plot(list(best), [100 * value / most for value in best.values()], **style)
        for axes, column in ((panels[1], "objective"), (panels[2], "agreement")):
            middles = []
            for count, of in of_count.items():
                values = ([100 * stats.excess(row["objective"], best[count]) for row in of]
                          if column == "objective" else [row[column] for row in of])
                others = [value for value, row in zip(values, of) if not row["reference"]]
                middles.append(stats.median(others) if others else math.nan)
                axes.plot([count + 0.06 * (k - len(by_material) / 2)] * len(others), others, "o",
                          markersize=3, alpha=0.5, color=style["color"], label="_")
            axes.plot(list(of_count), middles, **{**style, "marker": ""})
    panels[0].set(yscale="log", title="lowest E over that of one lobe (%)")
    panels[1].set(title="E of the other runs above the lowest (%)")
    panels[1].set_yscale("symlog", linthresh=0.1)
    panels[1].set_ylim(-0.01, max(1, 2 * panels[1].get_ylim()[1]))
    panels[2].set(title="agreement of the lobes of another run", ylim=(-0.03, 1.03))
    for axes in panels:
        axes.set_xlabel("lobes")
        axes.set_xticks(sorted({row["lobes"] for row in rows}))
    plots.plain_numbers(panels[0].yaxis)
    plots.plain_numbers(panels[1].yaxis)
    plots.legend_above(figure, panels[0])
    return figure


def _spectra_figure(rows):
    """Singular values, a panel a material, a line a number of lobes."""
    from lab import plots
    by_material = tables.groups(rows, "material")
    figure, panels = plots.plt.subplots(1, len(by_material), sharey=True, squeeze=False,
                                        figsize=(3.6 * len(by_material) + 1, 4.4))
    colours = plots.plt.get_cmap("cividis")
    counts = sorted({row["lobes"] for row in rows})
    for axes, (material, of_material) in zip(panels.flat, by_material.items()):
        for count, of in sorted(tables.groups(of_material, "lobes").items()):
            axes.plot([row["number"] for row in of],
                      [max(row["relative_singular_value"], 1e-12) for row in of],
                      color=colours(0.9 * counts.index(count) / max(1, len(counts) - 1)),
                      label=f"{count} lobe{'s' if count > 1 else ''}")
        axes.set(yscale="log", title=material, xlabel="number, by size")
    panels[0, 0].set_ylabel("singular value over the largest")
    plots.legend_above(figure, panels[0, 0])
    return figure


def _percent(rows, holds):
    return f"{100 * sum(map(holds, rows)) / len(rows):.0f}" if rows else "–"


def _range(values, digits=3):
    values = [value for value in values if value is not None]
    if not values:
        return "–"
    low, high = (f"{stats.quantile(values, q):.{digits}g}" for q in (.05, .95))
    return f"{statistics.median(values):.{digits}g} [{low}, {high}]"


def _same(rows, column="agreement"):
    """How many runs have the lobes of the run that they are compared with, that one left out, %."""
    others = [row for row in rows if row[column] is not None and not (column == "agreement" and row["reference"])]
    return _percent(others, lambda row: row[column] >= SAME)


def _stops(rows):
    """Why they stopped: "converged 18, max_iterations 2"."""
    return ", ".join(f"{reason} {len(of)}" for reason, of in tables.groups(rows, "stop_reason").items())


def _materials_with(rows, column):
    """The number of materials on which STABLE of the runs have the same lobes."""
    count = 0
    for of in tables.groups(rows, "material").values():
        others = [row for row in of if row[column] is not None and not (column == "agreement" and row["reference"])]
        count += bool(others) and sum(row[column] >= SAME for row in others) >= STABLE * len(others)
    return count


def _seen(rows):
    """Differences of the sphere's PSNR between the runs on a material: median and range over the materials."""
    values = [[row["psnr_db"] for row in of] for of in tables.groups(rows, "material").values()]
    return _range([max(of) - min(of) for of in values], 2)


def _solvers_table(rows):
    """A line a solver, over all materials."""
    return tables.markdown(
        ["solver", "materials", "runs", "lobes of the lowest run, %", "lobes of its own lowest run, %",
         "own on 90 % of the starts: materials", "agreement with the lowest", "within 1 % of the lowest E, %",
         "E above the lowest, %", "scaled gradient", "iterations", "why they stopped", "PSNR differs by, dB",
         "s a run"],
        [[solver, str(len({row["material"] for row in of})), str(len(of)), _same(of), _same(of, "own_agreement"),
          str(_materials_with(of, "own_agreement")),
          _range([row["agreement"] for row in of if not row["reference"]], 2),
          _percent(of, lambda row: row["excess"] <= SUCCESS), _range([100 * row["excess"] for row in of]),
          _range([row["optimality"] for row in of], 2), _range([row["iterations"] for row in of]), _stops(of), _seen(of),
          f"{numpy.mean([row['seconds'] for row in of]):.2g}"]
         for solver, of in tables.groups(rows, "solver").items()])


def _noise_table(rows):
    return tables.markdown(
        ["solver", "materials", "noisy fits", "lobes of the fit without noise, %",
         "in all draws: materials", "agreement", "scaled gradient", "why they stopped"],
        [[solver, str(len({row["material"] for row in of})), str(len(of)), _same(of),
          str(sum(all(row["agreement"] >= SAME for row in draws)
                  for draws in tables.groups(of, "material").values())),
          _range([row["agreement"] for row in of], 2), _range([row["optimality"] for row in of], 2), _stops(of)]
         for solver, of in tables.groups(rows, "solver").items()])


def _stability_table(rows):
    """A line a material and solver; shares of the lobes are in the order of the reference's."""
    return tables.markdown(
        ["material", "solver", "n", "lowest E", "above the lowest, %", "scaled gradient", "agreement",
         "of its lobes, %", "of its own, %", "collapsed, %", "copies, %", "blown up, %", "sphere PSNR, dB",
         "why they stopped"],
        [[material, solver, str(len(of)), f"{min(row['objective'] for row in of):.5g}",
          _range([100 * row["excess"] for row in of]), _range([row["optimality"] for row in of], 2),
          _range([row["agreement"] for row in of if not row["reference"]]), _same(of), _same(of, "own_agreement"),
          _percent(of, lambda row: row["collapsed"]), _percent(of, lambda row: row["likest_pair"] > COPY),
          _percent(of, lambda row: row["albedo_over_reference"] > BLOWN_UP),
          _range([row["psnr_db"] for row in of], 4), _stops(of)]
         for (material, solver), of in sorted(tables.groups(rows, "material", "solver").items())])


def _lobes_table(rows):
    lines = []
    before = {}
    for (material, count), of in sorted(tables.groups(rows, "material", "lobes").items()):
        best = min(row["objective"] for row in of)
        gain = (f"{100 * (1 - best / before[material, count - 1]):.2f}"
                if (material, count - 1) in before else "–")
        before[material, count] = best
        lines.append([material, str(count), str(len(of)), f"{best:.6g}", gain,
                      _percent(of, lambda row, best=best: row["objective"] <= (1 + SUCCESS) * best),
                      _range([row["agreement"] for row in of if not row["reference"]]), _same(of),
                      _percent(of, lambda row: row["collapsed"]),
                      _percent(of, lambda row: row["likest_pair"] > COPY),
                      _range([row["optimality"] for row in of], 2), _stops(of),
                      f"{stats.median([row['condition'] or math.inf for row in of]):.2g}",
                      str(max(row["unresolved"] or 0 for row in of))])
    return tables.markdown(
        ["material", "lobes", "runs", "lowest E", "less than with one lobe fewer, %",
         "within 1 % of it, %", "agreement", "the same, %", "collapsed, %", "copies, %", "scaled gradient",
         "why they stopped", "condition of J", "unresolved, at most"], lines)


def _weakest_table(rows):
    return tables.markdown(
        ["material", "lobes", "direction", "singular value over the largest",
         "moves (share of its length²)", "largest at"],
        [[row["material"], str(row["lobes"]), str(row["number"]),
          f"{row['relative_singular_value']:.2g}", row["moves"],
          f"{row['largest_in']}, entry {row['entry']}"] for row in rows])


def draw(drawn, _):
    products = {}
    of = {run: [row for row in drawn["runs"] if row["run"] == run] for run in (STARTS, NOISE, "lobes")}
    if of[STARTS]:
        products["solvers.md"] = _solvers_table(of[STARTS])
        products["stability.md"] = _stability_table(of[STARTS])
        products["stability"] = _stability_figure(of[STARTS])
        products["shares"] = _shares_figure(of[STARTS])
    if of[NOISE]:
        products["noise.md"] = _noise_table(of[NOISE])
    if of["lobes"]:
        products["lobes.md"] = _lobes_table(of["lobes"])
        products["lobes"] = _lobes_figure(of["lobes"])
    if drawn["spectra"]:
        products["spectra"] = _spectra_figure(drawn["spectra"])
        products["weakest.md"] = _weakest_table(drawn["weakest"])
    return products
