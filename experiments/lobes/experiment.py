"""Stability of the lobes: see README.md beside this file."""
import json
import math
import pathlib
import statistics

import numpy

from lab import fits, lobes, records, stats, tables
from lab.fits import Fit
from lab.units import FOLDER, Product, Unit

SUCCESS = 0.01  # of E above the best: as good
COLLAPSED = 1e-4  # of the reflected light: less is no lobe
COPY = 0.99  # match score of two lobes of one model
BLOWN_UP = 2.0  # times what the reference reflects
AGREEING = 0.9  # match score of the least alike of a run's lobes
STABLE = 0.9  # of a material's runs agree


def _noisy_fits(setting):
    """Fits to noisy copies, and the fit without noise that they are compared with."""
    asked = setting.manifest["noise"]
    if asked is None:
        return []
    flags = {**setting.manifest["flags"], **asked["flags"]}
    units = []
    for source in setting.every(asked.get("every", 1)):
        plain = fits.fit(setting, source, asked["solver"], flags,
                         weighting=asked.get("weighting", fits.DEFAULT), run="noise-free")
        units.append(plain)
        words = [word for word in plain.arguments[3:]
                 if not word.startswith(("--noise=", "--seed="))]
        for draw in range(1, asked["draws"] + 1):
            units.append(Unit(
                f"fit/{source.name}/{asked['solver']}-noisy",
                pathlib.Path(__file__).with_name("noisy_fit"),
                (str(setting.program()), source.path, str(asked["sigma"]), str(draw), FOLDER,
                 *words), "report.json", labels={**plain.labels, "seed": draw, "run": "noise"}))
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
    return fitted + _noisy_fits(setting) + spectra


# --- tables ---------------------------------------------------------------------------------------


def _reported_albedos(light):
    """As lobes.albedos, from the member "light" of a report."""
    return numpy.array([numpy.mean(part["albedo"]) for part in (*light["lobes"], light["diffuse"])])


class _Run:
    """A fit, its model and its lobes' albedos."""

    def __init__(self, result, clock):
        self.labels = result.labels
        self.key = result.unit.key
        fit = Fit(result.folder, clock)
        self.report = fit.report
        self.seconds = fit.solved
        self.model = lobes.Model.read(result.folder / "model.json")
        self.albedos = (lobes.albedos(self.model) if self.report["model"] != "anisotropic"
                        else _reported_albedos(self.report["light"]))
        self.order = None  # its lobes in the order of the reference's

    @property
    def group(self):
        """Runs that should have the same lobes, and are compared with one of them."""
        run = self.labels["run"]
        return self.labels["material"], run.replace("noise-free", "noise"), self.model.lobes

    def compare(self, reference):
        """Sets the order. Returns the match scores, lobe by lobe of the reference's by size."""
        by_size = numpy.argsort(-reference.albedos[:-1], kind="stable")
        table = lobes.scores(reference.model, self.model)[by_size]
        self.order = lobes.assign(table)
        self.swapped = tuple(by_size) != self.order
        return [table[row, column] for row, column in enumerate(self.order)]


def _references(runs):
    """{group: the run of the lowest E of the seeded ones, or the one without noise}"""
    references = {}
    for run in runs:
        if run.labels["run"] == "noise":
            continue
        best = references.setdefault(run.group, run)
        if run.report["objective"] < best.report["objective"]:
            references[run.group] = run
    return references


def _row(run, reference):
    report, labels = run.report, run.labels
    matches = run.compare(reference)
    total = float(run.albedos.sum())
    shares = run.albedos / total if total > 0 else run.albedos
    diagnosis = report["diagnosis"] or {}
    return {
        "run": labels["run"], "material": labels["material"], "solver": labels["solver"],
        "lobes": run.model.lobes, "seed": labels["seed"], "objective": report["objective"],
        # Under noise E is mostly noise, which a model must not follow.
        "over_record": records.excess(report["objective"], report, labels["material"]),
        "excess": (stats.excess(report["objective"], reference.report["objective"])
                   if run.group[1] != "noise" else None),
        "seconds": run.seconds,
        "stop_reason": report["stop_reason"], "iterations": report["iterations"],
        "reference": int(run.key == reference.key), "least_match": min(matches, default=1.0),
        "light_match": float(numpy.average(matches, weights=shares[list(run.order)]))
        if sum(shares[list(run.order)]) > 0 else None,
        "swapped": int(run.swapped), "collapsed": int((shares[:-1] < COLLAPSED).any()),
        "likest_pair": lobes.likest_pair(run.model),
        "albedo": total, "albedo_over_reference": total / float(reference.albedos.sum()),
        **{f"share_{k + 1}": float(shares[m]) for k, m in enumerate(run.order)},
        "share_diffuse": float(shares[-1]),
        "psnr_db": (report.get("appearance") or {}).get("psnr_db"),
        **{name: diagnosis.get(name) for name in ("rank", "condition", "unresolved")}}


def _bands(runs, reference):
    """Spread of each table entry over runs; lobes as numbered by the reference."""
    rows = []
    for factor in "DFG":
        orders = [range(lobes.CHANNELS) if factor == "F" else run.order for run in runs]
        # [runs][tables][entries]
        values = numpy.array([getattr(run.model, factor)[list(order)]
                              for run, order in zip(runs, orders)])
        observed = numpy.array([run.model.observed[factor][list(order)]
                                for run, order in zip(runs, orders)]).all(axis=0)
        of_reference = getattr(reference.model, factor)
        if factor != "F":
            of_reference = of_reference[list(reference.order)]
        for table, entry in zip(*numpy.nonzero(observed)):
            of = values[:, table, entry]
            low, middle, high = (float(f"{value:.4g}") for value in stats.spread(of, .05))
            rows.append({"factor": factor, "table": int(table) + 1, "entry": int(entry),
                         "runs": len(runs), "low": low, "median": middle, "high": high,
                         "reference": float(f"{of_reference[table, entry]:.4g}")})
    return rows


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
    runs = [_Run(result, fits.clock(setting)) for result in results
            if result.folder and result.labels["run"] != "spectrum"]
    references = _references(runs)
    compared = [run for run in runs if run.group in references]
    rows = [_row(run, references[run.group]) for run in compared]
    shown = setting.manifest["shown"]
    bands = []
    for group, reference in references.items():
        material, kind, _ = group
        of = [run for run in compared if run.group == group and run.labels["run"] == kind
              and (kind == "noise" or run.labels["solver"] == shown["solver"])]
        if of and kind != "lobes" and material in shown.get("materials", [material]):
            bands += [{"run": kind, "material": material, **row} for row in _bands(of, reference)]
    order_of = {run.key: run.order for run in compared if run.labels["run"] == "lobes"}
    spectra, weakest = [], []
    for result in results:
        if not result.folder or result.labels["run"] != "spectrum":
            continue
        spectrum = json.loads((result.folder / "stdout.txt").read_text())
        order = order_of[result.unit.needs[0].key]
        labels = {"material": result.labels["material"], "lobes": len(order)}
        values = spectrum["singular_values"]
        spectra += [{**labels, "number": k + 1, "relative_singular_value": value / values[0],
                     "columns": spectrum["columns"],
                     "gauge_directions": spectrum["gauge_directions"]}
                    for k, value in enumerate(values)]
        weakest += [{**labels, **row} for row in _weakest(spectrum, order)]
    missing = [{**{key: result.labels[key] for key in ("run", "material", "solver", "seed")},
                "unit": result.unit.path} for result in results if not result.folder]
    return {"runs": rows, "bands": bands, "spectra": spectra, "weakest": weakest,
            "missing": missing}


# --- pictures -------------------------------------------------------------------------------------


def _bands_figure(rows, title):
    """Rows of panels: materials. Columns: D and G of each lobe, F of each channel."""
    from lab import plots
    by_material = tables.groups(rows, "material")
    lobe_colours = (plots.BLUE, plots.ORANGE, plots.PURPLE, plots.GREEN, plots.BLACK)
    channel_colours = (plots.VERMILION, plots.GREEN, plots.BLUE)
    columns = (("D", "D against θh (degrees)", lobe_colours, "lobe {}"),
               ("F", "F against θd (degrees)", channel_colours, "{}"),
               ("G", "G against θi and θo (degrees)", lobe_colours, "lobe {}"))
    figure, panels = plots.plt.subplots(len(by_material), 3, squeeze=False,
                                        figsize=(12.5, 2.9 * len(by_material) + 0.7))
    for line, (material, of_material) in zip(panels, by_material.items()):
        for axes, (factor, label, colours, name) in zip(line, columns):
            of_factor = [row for row in of_material if row["factor"] == factor]
            for table, of in tables.groups(of_factor, "table").items():
                entries = numpy.array([row["entry"] for row in of])
                x = (entries + 0.5) ** 2 / 90 if factor == "D" else entries + 0.5
                low, middle, high, best = (numpy.array([row[column] for row in of]) for column in
                                           ("low", "median", "high", "reference"))
                colour = colours[table - 1]
                which = ("red", "green", "blue")[table - 1] if factor == "F" else table
                axes.fill_between(x, low, high, color=colour, alpha=0.25, linewidth=0)
                axes.plot(x, middle, color=colour, linewidth=1.5, label=name.format(which))
                axes.plot(x, best, color=colour, linewidth=1, linestyle=":")
            if factor == "D":
                top = max(row["high"] for row in of_factor)
                axes.set(xscale="log", yscale="log", ylim=(1e-6 * top, 2 * top))
                plots.plain_numbers(axes.xaxis)
                axes.set_ylabel(material, fontsize=10)
            elif factor == "F":
                top = max(row["high"] for row in of_factor)
                axes.set(yscale="log", ylim=(1e-4 * top, 2 * top))
            else:
                axes.set_ylim(bottom=0)
            axes.set_xlabel(label)
            axes.legend(fontsize=8)
    runs = {row["runs"] for row in rows}
    figure.suptitle(f"{title}: 5 to 95 % of {min(runs)} runs (band), median (line), reference "
                    "(dotted)", x=0.01, ha="left")
    return figure


def _shares_figure(rows):
    """What each lobe reflects, a dot a run."""
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
    """A line a material: the least match and E of each run of the solver shown, and noise."""
    from lab import plots
    kinds = {"starts": (plots.BLUE, "another seed"), "noise": (plots.ORANGE, "noise")}
    kinds = {kind: of for kind, of in kinds.items() if any(row["run"] == kind for row in rows)}
    by_material = tables.groups([row for row in rows if not row["reference"]], "material")
    names = sorted(by_material, key=lambda name: stats.median(
        [row["least_match"] for row in by_material[name]]))
    figure, panels = plots.plt.subplots(1, 3, sharey=True,
                                        figsize=(13, 0.42 * len(names) + 1.6))
    for y, name in enumerate(names):
        for k, (kind, (colour, label)) in enumerate(kinds.items()):
            of = [row for row in by_material[name] if row["run"] == kind]
            heights = y + 0.18 * (1 - 2 * k) + 0.14 * (numpy.linspace(-1, 1, len(of))
                                                      if len(of) > 1 else numpy.zeros(len(of)))
            style = {"color": colour, "markersize": 4, "alpha": 0.75, "linestyle": "",
                     "marker": "o", "label": label if y == 0 else "_"}
            panels[0].plot([row["least_match"] for row in of], heights, **style)
            if kind == "starts":
                panels[1].plot([100 * max(row["excess"], 1e-6) for row in of], heights, **style)
                panels[2].plot([row["psnr_db"] for row in of], heights, **style)
    panels[0].axvline(AGREEING, color=plots.GREY, linewidth=1)
    panels[0].set(xlim=(-0.03, 1.03), xlabel="match of the least alike lobe (1: the same)")
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
        for axes, column in ((panels[1], "objective"), (panels[2], "least_match")):
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
    panels[2].set(title="least match score of the lobes of another run", ylim=(-0.03, 1.03))
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
    if not values:
        return "–"
    low, middle, high = (f"{value:.{digits}g}" for value in stats.spread(values, .05))
    return f"{middle} [{low}, {high}]"


def _agree(rows):
    """Of the runs that are not the reference, which agrees with itself, how many do, %."""
    others = [row for row in rows if not row["reference"]]
    return _percent(others, lambda row: row["least_match"] >= AGREEING)


def _success_table(rows, missing):
    """A fit that is missing is no success; what it took is not known."""
    lines = []
    missing = [row for row in missing if row["run"] == "starts"]
    groups = tables.with_missing(rows, missing, "material", "solver")
    for material, solver in sorted(groups):
        of, lost = groups[material, solver]
        if not of:
            lines.append([material, solver, tables.count(lost, lost), "0", *["–"] * 3, "never"])
            continue
        own_best = min(row["objective"] for row in of)
        rate = sum(row["excess"] <= SUCCESS for row in of) / (len(of) + lost)
        seconds = statistics.fmean(row["seconds"] for row in of)
        second = f"{2 * seconds / rate:.1f}" if rate > 0 else "never"
        lines.append([material, solver, tables.count(len(of) + lost, lost), f"{100 * rate:.0f}",
                      _percent(of, lambda row: row["objective"] <= (1 + SUCCESS) * own_best),
                      _range([100 * row["excess"] for row in of]), f"{seconds:.1f}", second])
    return tables.markdown(
        ["material", "solver", "runs", "within 1 % of the best, %", "of its own best, %",
         "E above the best, %", "s a run", "s to the second success"], lines)


def _stability_table(rows):
    lines = []
    rows = sorted(rows, key=lambda row: (row["run"] == "noise", row["material"], row["solver"]))
    for (run, material, solver), of in tables.groups(rows, "run", "material", "solver").items():
        others = [row for row in of if not row["reference"]]
        lines.append([
            run, material, solver, str(len(of)), _range([row["least_match"] for row in others]),
            _range([row["light_match"] for row in others if row["light_match"] is not None]),
            _agree(of),
            _percent(of, lambda row: row["swapped"]), _percent(of, lambda row: row["collapsed"]),
            _percent(of, lambda row: row["likest_pair"] > COPY),
            _percent(of, lambda row: row["albedo_over_reference"] > BLOWN_UP),
            f"{max(row['albedo_over_reference'] for row in of):.4g}",
            _range([row["psnr_db"] for row in of if row["psnr_db"] is not None], 4)])
    return tables.markdown(
        ["runs of", "material", "solver", "n", "least match", "match by light", "agree, %",
         "swapped, %", "collapsed, %", "copies, %", "blown up, %", "largest albedo",
         "sphere PSNR, dB"], lines)


def _stable_table(rows):
    """On how many materials the same lobes come back."""
    lines = []
    for (run, solver), of in tables.groups(rows, "run", "solver").items():
        by_material = tables.groups([row for row in of if not row["reference"]], "material")
        agree = {name: sum(row["least_match"] >= AGREEING for row in runs) / len(runs)
                 for name, runs in by_material.items()}
        lines.append([run, solver, str(len(agree)),
                      *(str(sum(share >= least for share in agree.values()))
                        for least in (STABLE, 0.5)),
                      ", ".join(name for name, share in agree.items() if share < STABLE) or "–"])
    return tables.markdown(["runs of", "solver", "materials",
                            f"{100 * STABLE:.0f} % of the runs agree on", "half of them on",
                            "fewer agree on"], lines)


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
                      _range([row["least_match"] for row in of if not row["reference"]]),
                      _agree(of),
                      _percent(of, lambda row: row["collapsed"]),
                      _percent(of, lambda row: row["likest_pair"] > COPY),
                      f"{stats.median([row['condition'] or math.inf for row in of]):.2g}",
                      str(max(row["unresolved"] or 0 for row in of))])
    return tables.markdown(
        ["material", "lobes", "runs", "lowest E", "less than with one lobe fewer, %",
         "within 1 % of it, %", "least match", "agree, %", "collapsed, %", "copies, %",
         "condition of J", "unresolved, at most"], lines)


def _weakest_table(rows):
    return tables.markdown(
        ["material", "lobes", "direction", "singular value over the largest",
         "moves (share of its length²)", "largest at"],
        [[row["material"], str(row["lobes"]), str(row["number"]),
          f"{row['relative_singular_value']:.2g}", row["moves"],
          f"{row['largest_in']}, entry {row['entry']}"] for row in rows])


def draw(drawn, _):
    products = {}
    starts = [row for row in drawn["runs"] if row["run"] == "starts"]
    by_count = [row for row in drawn["runs"] if row["run"] == "lobes"]
    noise = [row for row in drawn["runs"] if row["run"] == "noise"]
    if starts:
        products["success.md"] = _success_table(starts, drawn["missing"])
        products["shares"] = _shares_figure(starts)
    if starts or noise:
        products["stability.md"] = _stability_table(starts + noise)
        products["stable.md"] = _stable_table(starts + noise)
        solver = noise[0]["solver"] if noise else starts[0]["solver"]
        products["stability"] = _stability_figure(
            [row for row in starts + noise if row["solver"] == solver])
    if by_count:
        products["lobes.md"] = _lobes_table(by_count)
        products["lobes"] = _lobes_figure(by_count)
    for run, title, name in (("starts", "Seeded starts", "seeded"),
                             ("noise", "Noise draws", "noise")):
        of = [row for row in drawn["bands"] if row["run"] == run]
        if of:
            products[f"bands_{name}"] = _bands_figure(of, title)
    if drawn["spectra"]:
        products["spectra"] = _spectra_figure(drawn["spectra"])
        products["weakest.md"] = _weakest_table(drawn["weakest"])
    return products
