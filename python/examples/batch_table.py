#!/usr/bin/env python3
"""Batches: a hundred measurements, fitted side by side, and what became of them as a table of pandas.

batch_table.py [--quick] [--out=FOLDER] [--program=PATH]     writes table.csv: PSNR by material and noise
"""

import argparse
import pathlib

import pandas

import trilobe

MATERIALS = ["plastic", "car-paint", "copper", "aluminium", "chrome", "felt", "foam", "rubber"]
NOISE = [0.0, 0.01, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5]


def main():
    """Fits eight synthetic measurements with more and more noise; files or folders would be fitted in the same way."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="four fits of two iterations")
    parser.add_argument("--out", default="out/batch_table", type=pathlib.Path)
    parser.add_argument("--program", help="the trilobe to run; by default the one beside this Python, or on the PATH")
    arguments = parser.parse_args()
    materials, noises = (MATERIALS[:2], NOISE[:3:2]) if arguments.quick else (MATERIALS, NOISE)
    tables = []
    for noise in noises:
        # Finished fits are kept, so that a batch that was cut off goes on.
        rows = trilobe.fit_many(
            [f"synth:{name}@24x24x48" for name in materials], arguments.out / f"noise-{noise:g}", noise=noise,
            program=arguments.program, solver="awls", max_iterations=2 if arguments.quick else 20)
        tables.append(pandas.DataFrame(rows).assign(noise=noise))
    fits = pandas.concat(tables)
    print(f"{len(fits)} fits, {(fits.state != 'failed').sum()} of them good, in {fits.seconds.sum():.1f} s")
    psnr = fits.pivot_table(index="source", columns="noise", values="psnr_db").round(1)
    print(psnr.to_string())
    psnr.to_csv(arguments.out / "table.csv")


if __name__ == "__main__":
    main()
