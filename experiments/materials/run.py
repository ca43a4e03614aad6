#!/usr/bin/env python3
"""Fits many materials with the program's defaults and writes the table of docs/materials.md.

Usage: experiments/materials/run.py [--program build/release/bin/trilobe] [--out out/materials]
                                    [--table docs/materials.md] SOURCE [SOURCE ...] [-- FLAG ...]

Sources are MERL .binary or RGL *_rgb.bsdf files, or synth:NAME. A material that the same command
has fitted into the out folder is not fitted again. Flags after -- are handed to `trilobe fit`. Needs nothing but
Python.
"""
import argparse
import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from fits import fit_once, material_name  # noqa: E402

COLUMNS = "material | valid bins | E at the start | E | % of black | PSNR dB | peak /sr | mean rel. error % | iterations | stopped by | solve s | all s"


def fit(program, source, folder, flags):
    """The report of one fit."""
    command = [program, "fit", source, f"--out={folder}", *flags]
    return json.loads(fit_once(command, folder, "report.json").read_text())


def row(name, report):
    seconds = report["seconds"]
    return " | ".join([
        name, str(report["valid_samples"]), f"{report['initial_objective']:.4g}",
        f"{report['objective']:.5g}", f"{100 * report['relative_objective']:.3g}",
        f"{report['psnr_db']:.1f}", f"{report['psnr_peak']:.3g}",
        f"{100 * report['mean_relative_error']:.2f}", str(report["iterations"]),
        report["stop_reason"], f"{seconds['solve']:.2f}", f"{sum(seconds.values()):.2f}"])


def main():
    arguments, flags = sys.argv[1:], []
    if "--" in arguments:
        at = arguments.index("--")
        arguments, flags = arguments[:at], arguments[at + 1:]
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/trilobe")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/materials"))
    parser.add_argument("--table", type=pathlib.Path, help="write the table here too")
    parser.add_argument("sources", nargs="+")
    options = parser.parse_args(arguments)

    lines = ["| " + COLUMNS + " |", "|---" * (COLUMNS.count("|") + 1) + "|"]
    print("\n".join(lines), flush=True)
    for source in options.sources:
        name = material_name(source)
        lines.append("| " + row(name, fit(options.program, source,
                                          options.out / name.replace(":", "-"), flags)) + " |")
        print(lines[-1], flush=True)
    if options.table:
        options.table.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
