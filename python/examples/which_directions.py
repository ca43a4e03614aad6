#!/usr/bin/env python3
"""Which directions to measure next, of a material of which 20 are measured.

which_directions.py [--quick] [--out=FOLDER]     draws directions.png: what is measured, and what comes next
"""

import argparse
import pathlib

import matplotlib
import numpy as np

import trilobe

matplotlib.use("agg")


def main():
    """Measures a plan of 20 directions of a model, with noise, and asks for 10 more."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="half as many")
    parser.add_argument("--out", default="out/which_directions", type=pathlib.Path)
    arguments = parser.parse_args()
    count = 10 if arguments.quick else 20
    truth = trilobe.load("material:satin_purple")
    at = trilobe.directions_to_measure(count)
    rho = truth.eval(at.wi, at.wo) * np.exp(0.02 * np.random.default_rng(1).normal(size=(count, 3)))
    measured = trilobe.Measurement(at.wi, at.wo, rho)
    found = trilobe.next_directions(measured, count // 2, progress=False)
    print("theta_i, phi_i, theta_o, phi_o [degrees]")
    print(found.directions.angles.round(2))
    arguments.out.mkdir(parents=True, exist_ok=True)
    trilobe.plot.directions(found.directions, measured).savefig(arguments.out / "directions.png", dpi=90)


if __name__ == "__main__":
    main()
