#!/usr/bin/env python3
"""Fits a scene as a whole and within several budgets; tabulates and draws error against size and time.

    experiments/scene/run.py FOLDER...           the scene of materials.txt, its files in these folders
    experiments/scene/run.py --quick             a synthetic material, seconds; says nothing
"""
import argparse
import csv
import json
import pathlib
import shutil
import subprocess
import sys

BUDGETS = (0.001, 0.01, 0.05, 0.2)  # relative rise of E
MANIFEST = pathlib.Path(__file__).parent / "materials.txt"
QUICK_FLAGS = ["--solver=awls", "--max_iterations=2", "--lobes=1"]
LOWEST_RISE = 0.02  # %, where pictures draw what is below
CURVE, WHOLE = "#0072B2", "#D55E00"  # Okabe and Ito 2008


def read_manifest(folders):
    """[(name, path of its file)] of all materials of the manifest; exits if a file is not there."""
    materials, missing = [], []
    for line in MANIFEST.read_text().splitlines():
        if not line or line.startswith("#"):
            continue
        name, file = line.split()
        found = [folder / file for folder in folders if (folder / file).is_file()]
        if not found:
            missing.append(file)
        else:
            materials.append((name, str(found[0].resolve())))
    if missing:
        sys.exit(f"no such file in the folders given: {', '.join(missing)}")
    return materials


def percent(budget):
    return f"{100 * budget:g} %"


def run(command):
    """The standard output of a command, which must succeed."""
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def fit_and_compare(options, materials, budget):
    """What `trilobe compare --json` says of the scene with this budget, in a folder of its own."""
    folder = options.out / f"rise_{budget:g}"
    folder.mkdir(parents=True, exist_ok=True)
    scene = folder / "scene.json"
    scene.write_text(json.dumps(
        {"format": "trilobe-scene", "version": 1, "budget": {"relative_rise": budget},
         "materials": [{"name": name, "source": source} for name, source in materials]}, indent=1))
    cache = f"--cache={options.out / 'cache'}"
    flags = [*options.flags, cache]
    # A fresh look at the time of the whole scene: what an earlier budget fitted must not help.
    if options.cold:
        shutil.rmtree(options.out / "cache", ignore_errors=True)
    print(f"budget {percent(budget)}", flush=True)
    run([options.program, "fit", f"--scene={scene}", f"--out={folder / 'models'}", *flags])
    text = run([options.program, "compare", str(folder / "models"), "--json", cache,
                f"--out={folder / 'trade_off.png'}"])
    (folder / "compare.json").write_text(text)
    return json.loads(text)


def write_csv(path, results):
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["material", "budget", "numbers_full", "numbers_pruned", "seconds_full",
                         "seconds_pruned", "objective_full", "objective_pruned", "relative_rise",
                         "psnr_full_db", "psnr_pruned_db"])
        for budget, result in results.items():
            for of in result["materials"]:
                full, pruned = of["full"], of["pruned"]
                writer.writerow([of["name"], budget, full["numbers"], pruned["numbers"],
                                 full["seconds"], pruned["seconds"], full["objective"],
                                 pruned["objective"], of["relative_rise"], full["psnr_db"],
                                 pruned["psnr_db"]])


def write_table(path, results):
    budgets = list(results)
    lines = ["Numbers that a model stores, by the rise of E that is allowed:", "",
             "| material | full | " + " | ".join(map(percent, budgets)) + " |",
             "|---" * (2 + len(budgets)) + "|"]
    first = results[budgets[0]]["materials"]
    for k, material in enumerate(first):
        numbers = [results[budget]["materials"][k]["pruned"]["numbers"] for budget in budgets]
        lines.append(f"| {material['name']} | {material['full']['numbers']} | "
                     + " | ".join(map(str, numbers)) + " |")
    totals = [results[budget]["all"] for budget in budgets]
    full = totals[0]["numbers"]["full"]
    rows = [("all", full, [total["numbers"]["pruned"] for total in totals], "d"),
            ("all, times fewer", 1, [full / total["numbers"]["pruned"] for total in totals], ".1f"),
            ("seconds, the whole scene", f"{totals[0]['seconds']['full']:.1f}",
             [total["seconds"]["pruned"] for total in totals], ".1f")]
    for label, whole, values, form in rows:
        lines.append(f"| {label} | {whole} | " + " | ".join(f"{x:{form}}" for x in values) + " |")
    path.write_text("\n".join([*lines, ""]))


def draw(path, results, title, axis, value):
    """A panel a material: rise of E over value(side), from the full model on to larger budgets."""
    names = [of["name"] for of in next(iter(results.values()))["materials"]]
    columns = min(5, len(names))
    rows = -(-len(names) // columns)
    highest = 1.6 * max(100 * budget for budget in results)
    sides = [of[side] for result in results.values() for of in result["materials"]
             for side in ("full", "pruned")]
    low, high = min(map(value, sides)), max(map(value, sides))
    script = ["set encoding utf8",
              f"set terminal pngcairo noenhanced size {330 * columns},{110 + 300 * rows} "
              "background '#FFFFFF' font 'DejaVu Sans,12'", f"set output '{path}'",
              f"set multiplot layout {rows},{columns} title '{title}' font ',16'",
              "set border 3 linecolor '#555555'", "set tics nomirror out",
              "set grid linecolor '#E4E4E4' linetype 1", "set logscale xy",
              f"set xrange [{low / 1.6:g}:{high * 1.6:g}]",
              f"set yrange [{LOWEST_RISE / 1.5}:{highest}]",
              f"set ytics ('full' {LOWEST_RISE}, '0.1' 0.1, '1' 1, '5' 5, '20' 20)",
              f"set xlabel '{axis}'", "set ylabel 'rise of E (%)'", "unset key"]
    for k, name in enumerate(names):
        of = [result["materials"][k] for result in results.values()]
        points = [(value(entry["pruned"]),
                   min(max(100 * entry["relative_rise"], LOWEST_RISE), highest)) for entry in of]
        whole = (value(of[0]["full"]), LOWEST_RISE)
        script += [f"$curve{k} << EOD", *(f"{x:g} {y:g}" for x, y in points), "EOD",
                   f"$whole{k} << EOD", f"{whole[0]:g} {whole[1]:g}", "EOD",
                   f"set title '{name}'",
                   f"plot $curve{k} with linespoints pointtype 7 pointsize 1.2 linewidth 2.5 "
                   f"linecolor '{CURVE}', $whole{k} with points pointtype 6 pointsize 1.6 "
                   f"linewidth 2.5 linecolor '{WHOLE}'"]
    try:
        subprocess.run(["gnuplot", "--default-settings"], input="\n".join(script), text=True,
                       check=True)
    except FileNotFoundError:
        sys.exit("pictures need gnuplot, which is not on the PATH; install the package gnuplot-nox")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/trilobe")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--cold", action="store_true",
                        help="empty the cache before each budget, so that its seconds are of one run")
    parser.add_argument("--only", help="comma-separated names of materials; default: all")
    parser.add_argument("folders", nargs="*", type=pathlib.Path, metavar="FOLDER")
    options = parser.parse_args()
    if shutil.which(options.program) is None:
        parser.error(f"no program {options.program}; build it, or name another with --program")
    if options.out is None:
        options.out = pathlib.Path("out/scene-quick" if options.quick else "out/scene")
    if not options.quick and not options.folders:
        parser.error("give the folders of the files that materials.txt names, or --quick")
    options.flags = QUICK_FLAGS if options.quick else []
    options.budgets = BUDGETS[1::2] if options.quick else BUDGETS
    return options


def main():
    options = parse_arguments()
    if options.quick:
        materials = [("plastic", "synth:plastic")]
    else:
        materials = read_manifest(options.folders)
    if options.only is not None:
        materials = [entry for entry in materials if entry[0] in options.only.split(",")]
        if not materials:
            sys.exit(f"no material of {options.only}")
    results = {budget: fit_and_compare(options, materials, budget) for budget in options.budgets}
    write_csv(options.out / "results.csv", results)
    write_table(options.out / "table.md", results)
    draw(options.out / "error_against_bytes.png", results, "What error buys in bytes",
         "numbers of the model (bytes)", lambda side: side["bytes"])
    draw(options.out / "error_against_seconds.png", results, "What error buys in seconds",
         "time x threads to make it (s)", lambda side: side["seconds"] * side["threads"])
    print((options.out / "table.md").read_text(), end="")


if __name__ == "__main__":
    main()
