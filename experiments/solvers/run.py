#!/usr/bin/env python3
"""Which solver reaches the lowest E, and how fast? Fits every source with every solver.

Usage: experiments/solvers/run.py [--program build/release/bin/trilobe] [--out out/solvers]
                                  [--quick] [--solvers auto,awls] SOURCE [SOURCE ...]

Sources are MERL .binary or RGL *_rgb.bsdf files, or synth:NAME. Writes results.csv, table.md,
excess.png and data_profile.png into the out folder; README.md beside this script explains them. A
fit that the same command has made is not repeated; one that fails is shown as missing, and makes
the exit status 1. --quick makes one iteration of each fit, anew, into out/solvers-quick, of
synth:plastic if no source is given. Needs nothing but Python and gnuplot.
"""
import argparse
import csv
import json
import math
import pathlib
import shutil
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from fits import fit_once, is_done, material_name  # noqa: E402

# The flags of each solver's fit; what is not named has the program's default.
SETTINGS = {
    "auto": {},
    "multistart": {"starts": 16},
    "hybrid": {},
    "varpro": {},
    "newton": {},
    "lm": {},
    "lm_plain": {},
    "awls": {"max_iterations": 500, "tolerance": 0},
    "awls_block": {"max_iterations": 200, "tolerance": 0},
    "awls_accelerated": {"max_iterations": 200, "tolerance": 0},
}
ONLY_WHEN_ASKED_FOR = {"lm_plain"}  # passes over all samples in every iteration

# All materials, whether a file is given or not: a material's half must not depend on that.
MERL = """
    alum-bronze aluminium black-obsidian black-oxidized-steel blue-acrylic blue-metallic-paint
    blue-rubber brass cherry-235 chrome color-changing-paint1 dark-blue-paint delrin
    gold-metallic-paint gold-paint green-fabric green-latex hematite ipswich-pine-221
    maroon-plastic nickel nylon pearl-paint pickled-oak-260 pink-felt polyethylene
    polyurethane-foam pvc red-fabric red-metallic-paint red-phenolic red-specular-plastic
    silver-metallic-paint specular-black-phenolic teflon tungsten-carbide violet-acrylic
    white-diffuse-bball white-paint yellow-matte-plastic""".split()
RGL = """
    acrylic_felt_green acrylic_felt_pink acrylic_felt_white aurora_white cc_green_malachite
    cc_ibiza_sunset cc_nothern_aurora cg_sunflower chm_mint chm_orange cm_toxic_green
    colodur_azure_4e colodur_napoli_4f ilm_l3_37_matte ilm_solo_m_68 irid_flake_paint1_fine
    irid_flake_paint2 leaf_maple paper_white satin_purple vch_dragon_eye_red vch_golden_yellow
    vch_ultra_pink""".split()
HALVES = {name: ("developing", "reporting")[i % 2]
          for names in (MERL, RGL) for i, name in enumerate(sorted(names))}
LOOKED_AT = {"chrome", "satin_purple", "leaf_maple"}  # while `auto` was developed, in any half

TARGETS = (0.05, 0.01)  # excess over the best E that a fit has to get below
SOON = 2.0  # s

# Okabe and Ito 2008, and a grey; a dashed line has a colour in common with its nearest relative.
# (colour, width, dashes)
STYLES = {
    "auto": ("#000000", 5, "solid"),
    "multistart": ("#D55E00", 3, "solid"),
    "hybrid": ("#009E73", 3, "solid"),
    "varpro": ("#0072B2", 3, "solid"),
    "newton": ("#E69F00", 3, "solid"),
    "lm": ("#CC79A7", 3, "solid"),
    "lm_plain": ("#CC79A7", 3, "(8,4)"),
    "awls": ("#56B4E9", 3, "solid"),
    "awls_block": ("#56B4E9", 3, "(8,4)"),
    "awls_accelerated": ("#808080", 3, "solid"),
}
LEAST_SHOWN_EXCESS = 0.01  # %


class Fit:
    """What is read of one fit: E, the times on one clock, and how it ended."""

    def __init__(self, folder):
        report = json.loads((folder / "report.json").read_text())
        seconds = report["seconds"]
        before = seconds["read"] + seconds["prepare"] + seconds["init"]  # the trace starts after it
        with open(folder / "trace.csv", newline="") as file:
            self.trace = [(before + float(row["seconds"]), float(row["objective"]))
                          for row in csv.DictReader(file)]
        self.objective = report["objective"]
        self.seconds = sum(seconds.values())
        self.stop_reason = report["stop_reason"]
        self.optimality = report["diagnosis"]["optimality"]  # None where it is not a number

    def seconds_to(self, objective):
        """When E was first at most this; infinite if never."""
        return next((seconds for seconds, value in self.trace if value <= objective), math.inf)


class Result:
    """A fit next to the best one of its material. `fit` is None if it is missing."""

    def __init__(self, fit, best):
        self.fit = fit
        self.excess = math.inf  # %
        self.seconds_to = {target: math.inf for target in TARGETS}
        if fit:
            self.excess = 100 * (fit.objective / best - 1) if fit.objective > best else 0.0
            self.seconds_to = {target: fit.seconds_to((1 + target) * best) for target in TARGETS}


def folder_name(source):
    return material_name(source).replace(":", "-")


def flags_of(solver, quick):
    flags = {"solver": solver, **SETTINGS[solver]}
    if quick:
        flags["max_iterations"] = 1
        if "starts" in flags:
            flags["starts"] = 2
    return [f"--{name}={value}" for name, value in flags.items()]


def duration(seconds):
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def seconds_left(jobs, taken):
    """Of the jobs that are still to run: each as long as its solver has taken on average so far."""
    everything = [seconds for times in taken.values() for seconds in times]
    return sum(statistics.fmean(taken[solver] or everything or [0]) for _, solver in jobs)


def run_fits(options):
    """{material: {solver: Fit, or None if it failed}}"""
    jobs = {}
    for source in options.sources:
        name = folder_name(source)
        for solver in options.solvers:
            folder = options.out / name / solver
            jobs[name, solver] = (folder, [options.program, "fit", source,
                                           *flags_of(solver, options.quick), f"--out={folder}"])
    to_run = [key for key, (folder, command) in jobs.items()
              if options.quick or not is_done(command, folder, "report.json")]
    taken = {solver: [] for solver in options.solvers}
    fits = {folder_name(source): {} for source in options.sources}
    for done, ((name, solver), (folder, command)) in enumerate(jobs.items(), start=1):
        try:
            fit = Fit(fit_once(command, folder, "report.json", again=options.quick).parent)
            taken[solver].append(fit.seconds)
            outcome = f"E {fit.objective:.5g} in {duration(fit.seconds)}"
        except subprocess.CalledProcessError as error:
            fit, outcome = None, f"failed with exit status {error.returncode}"
        fits[name][solver] = fit
        if (name, solver) in to_run:
            to_run.remove((name, solver))
            print(f"[{done}/{len(jobs)}] {name} {solver}: {outcome}; "
                  f"about {duration(seconds_left(to_run, taken))} left", file=sys.stderr)
    return fits


def compare(fits):
    """({material: best E, or None if all fits are missing}, {material: {solver: Result}})"""
    best = {name: min((fit.objective for fit in of_solver.values() if fit), default=None)
            for name, of_solver in fits.items()}
    return best, {name: {solver: Result(fit, best[name]) for solver, fit in of_solver.items()}
                  for name, of_solver in fits.items()}


def write_csv(path, results):
    def number(value):
        return f"{value:.6g}" if value is not None and math.isfinite(value) else ""

    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["material", "half", "solver", "objective", "excess_percent", "seconds",
                         *(f"seconds_to_{100 * target:g}_percent" for target in TARGETS),
                         "stop_reason", "optimality"])
        for name, of_solver in results.items():
            for solver, result in of_solver.items():
                row = [name, HALVES.get(name, ""), solver]
                if result.fit:
                    row += [f"{result.fit.objective:.10g}", number(result.excess),
                            number(result.fit.seconds),
                            *(number(result.seconds_to[target]) for target in TARGETS),
                            result.fit.stop_reason, number(result.fit.optimality)]
                else:
                    row += ["", "", "", *("" for _ in TARGETS), "missing", ""]
                writer.writerow(row)


def excess_cell(result):
    if not result.fit:
        return "missing"
    text = f"{result.excess:.2f}" if result.excess < 99.995 else f"{result.excess:.0f}"
    return f"**{text}**" if text == "0.00" else text


def summary(title, names, solvers, results):
    """Lines of a table of figures over these materials. What is missing or never reached counts as
    infinite, so it lowers no share and no median."""
    def row(label, figure):
        cells = [figure([results[name][solver] for name in names]) for solver in solvers]
        return f"| {label} | " + " | ".join(cells) + " |"

    def share(holds):
        return lambda of: f"{100 * sum(map(holds, of)) / len(of):.0f} %"

    def figure(reduce, value, unit):
        def cell(of):
            number = reduce([value(result) for result in of])
            return f"{number:.3g} {unit}" if math.isfinite(number) else "–"
        return cell

    lines = [f"{title} ({len(names)}):", "",
             "| | " + " | ".join(solvers) + " |", "|---" * (1 + len(solvers)) + "|"]
    for target in reversed(TARGETS):
        lines.append(row(f"within {100 * target:g} % of the best",
                         share(lambda result: result.excess <= 100 * target)))
    lines.append(row("median excess", figure(statistics.median, lambda r: r.excess, "%")))
    lines.append(row("largest excess", figure(max, lambda r: r.excess, "%")))
    for target in TARGETS:
        lines.append(row(f"median time to {100 * target:g} %",
                         figure(statistics.median, lambda r: r.seconds_to[target], "s")))
    lines.append(row(f"at {100 * TARGETS[-1]:g} % within {SOON:g} s",
                     share(lambda r: r.seconds_to[TARGETS[-1]] <= SOON)))
    return [*lines, ""]


def write_table(path, solvers, best, results):
    halves = {name: HALVES.get(name, "–") + (", looked at" if name in LOOKED_AT else "")
              for name in results}
    lines = ["Excess over the best E, in %:", "",
             "| material | half | best E | " + " | ".join(solvers) + " |",
             "|---" * (3 + len(solvers)) + "|"]
    for name, of_solver in results.items():
        cells = [excess_cell(of_solver[solver]) for solver in solvers]
        shown = "missing" if best[name] is None else f"{best[name]:.5g}"
        lines.append(f"| {name} | {halves[name]} | {shown} | " + " | ".join(cells) + " |")
    lines.append("")
    for title, is_in in (("All", lambda half: True),
                         ("Developing half", lambda half: half.startswith("developing")),
                         ("Reporting half", lambda half: half.startswith("reporting")),
                         ("Reporting half without the materials looked at",
                          lambda half: half == "reporting")):
        names = [name for name in results if is_in(halves[name])]
        if names:
            lines += summary(title, names, solvers, results)
    path.write_text("\n".join(lines))


def draw_shares(path, title, axis, values, lowest, marks):
    """Draws, for each solver, the share of its values that are at most x, over a logarithmic x.

    values: {solver: [one a material, infinite where there is none]}. What is below `lowest` is
    drawn there. marks: {x: its label}, to draw a vertical line there. The key has the solvers in
    the order of the mean heights of their curves.
    """
    finite = [value for of in values.values() for value in of if math.isfinite(value)]
    highest = 1.3 * max([*finite, *marks, 2 * lowest])
    script = ["set encoding utf8",
              "set terminal pngcairo noenhanced size 1200,720 background '#FFFFFF' "
              "font 'DejaVu Sans,16'",
              f"set output '{path}'", f"set title '{title}' offset 0,1",
              f"set xlabel '{axis}'", "set ylabel 'share of the materials (%)'",
              "set border 3 linecolor '#555555'", "set tics nomirror out",
              "set grid ytics linecolor '#E4E4E4' linetype 1",
              f"set logscale x; set format x '%g'; set xrange [{lowest}:{highest}]",
              "set yrange [-1:101]; set ytics 0,20,100",
              "set key outside right center Left reverse samplen 4 spacing 1.3"]
    if highest / lowest < 1e3:
        script += [f"set xtics add ({step * 10.0 ** power:g})" for power in range(-3, 6)
                   for step in (2, 5)]
    for mark, label in marks.items():
        script += [f"set arrow from {mark},graph 0 to {mark},graph 1 nohead back "
                   "linecolor '#999999' linewidth 1 dashtype (4,4)",
                   f"set label '{label}' at {mark},graph 1.03 center textcolor '#555555'"]
    curves, key = {}, {}
    for solver, of in values.items():
        drawn = sorted(min(max(value, lowest), highest) for value in of)
        height = -sum(map(math.log, drawn))
        points = [(lowest, 0), *((x, 100 * i / len(drawn)) for i, x in enumerate(drawn, start=1)
                                 if x < highest)]
        points = points[sum(x == lowest for x in drawn):]  # no rise along the edge
        points.append((highest, points[-1][1]))
        script += [f"${solver} << EOD", *(f"{x:.9g} {y:.9g}" for x, y in points), "EOD"]
        colour, width, dashes = STYLES[solver]
        style = f"linecolor '{colour}' linewidth {width} dashtype {dashes}"
        curves[solver] = f"${solver} using 1:2 with steps {style} notitle"
        key[height, solver] = f"keyentry with lines {style} title '{solver}'"
    script.append("plot " + ", ".join([*reversed(curves.values()),  # the first one on top
                                       *(key[entry] for entry in sorted(key, reverse=True))]))
    try:
        subprocess.run(["gnuplot", "--default-settings"], input="\n".join(script), text=True,
                       check=True)
    except FileNotFoundError:
        sys.exit("pictures need gnuplot, which is not on the PATH; install the package gnuplot-nox")


def draw(out, solvers, results):
    of_solver = {solver: [of[solver] for of in results.values()] for solver in solvers}
    draw_shares(out / "excess.png", f"How near to the best E (materials: {len(results)})",
                f"excess over the best E (%); {LEAST_SHOWN_EXCESS} or less at the left edge",
                {solver: [r.excess for r in of] for solver, of in of_solver.items()},
                LEAST_SHOWN_EXCESS, {100 * target: f"{100 * target:g} %" for target in TARGETS})
    target = TARGETS[-1]
    times = {solver: [r.seconds_to[target] for r in of] for solver, of in of_solver.items()}
    earliest = min((t for of in times.values() for t in of), default=SOON)
    draw_shares(out / "data_profile.png",
                f"How soon within {100 * target:g} % of the best E (materials: {len(results)})",
                "time from the start of reading (s)", times, 0.8 * min(earliest, SOON),
                {SOON: f"{SOON:g} s"})


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/trilobe")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--solvers", help="comma-separated; default: all but "
                        + ", ".join(sorted(ONLY_WHEN_ASKED_FOR)))
    parser.add_argument("sources", nargs="*", metavar="SOURCE")
    options = parser.parse_args()
    if shutil.which(options.program) is None:
        parser.error(f"no program {options.program}; build it, or name another with --program")
    if options.out is None:
        options.out = pathlib.Path("out/solvers-quick" if options.quick else "out/solvers")
    if options.quick and not options.sources:
        options.sources = ["synth:plastic"]
    if not options.sources:
        parser.error("give at least one source, or --quick")
    names = [folder_name(source) for source in options.sources]
    if len(set(names)) < len(names):
        parser.error("two sources are of the same material; give each once")
    if options.solvers is None:
        options.solvers = [name for name in SETTINGS if name not in ONLY_WHEN_ASKED_FOR]
    else:
        options.solvers = list(dict.fromkeys(options.solvers.split(",")))
        for solver in options.solvers:
            if solver not in SETTINGS:
                parser.error(f"unknown solver '{solver}'; known: {', '.join(SETTINGS)}")
    return options


def main():
    options = parse_arguments()
    fits = run_fits(options)
    best, results = compare(fits)
    options.out.mkdir(parents=True, exist_ok=True)
    write_csv(options.out / "results.csv", results)
    write_table(options.out / "table.md", options.solvers, best, results)
    draw(options.out, options.solvers, results)
    print((options.out / "table.md").read_text(), end="")
    missing = sum(fit is None for of in fits.values() for fit in of.values())
    if missing:
        sys.exit(f"missing fits: {missing}; the same command tries them again")


if __name__ == "__main__":
    main()
