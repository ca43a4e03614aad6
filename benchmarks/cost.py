#!/usr/bin/python3
"""Measures what docs/cost.md says: times of fits, of passes over the samples, and memory.

benchmarks/cost.py MERL_FOLDER [--build=build/release] [--rounds=3] [--out=benchmarks/results]

It wants the machine for itself, for a quarter of an hour. Each round fits each material and the example of a
goniometer by the defaults, on one thread and on two, with pictures and without, and takes a sweep of the literal AWLS in
the same minute, so that ratios to it hold on other machines. Then it fits samples on no grid, and runs fit_benchmark and
read_benchmark. Medians over the rounds go to fits.csv, samples.csv and passes.csv in the folder --out, and machine.json
says which machine and revision they are of. scripts/check_figures.py compares the page with them.
"""
import argparse
import csv
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.append(str(ROOT / "experiments"))
from lab import machine  # noqa: E402

MATERIALS = ["nylon", "chrome", "red-fabric", "aluminium", "alum-bronze", "violet-acrylic"]
GONIOMETER = ROOT / "docs/goniometer.csv"
BY_DEFAULT = {"default": ["--noplots"], "pictures": []}  # a default fit, without pictures and with them
SIZES = [100_000, 200_000]  # samples on no grid, whose difference tells what one costs
SEED = 1


def run(command):
    """Seconds by the clock, those of the processor, and the most memory [MB] that a command takes."""
    begin = time.monotonic()
    with tempfile.TemporaryFile() as said:
        process = subprocess.Popen([str(word) for word in command], stdout=said, stderr=said)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode != 0:
            said.seek(0)
            sys.exit(f"error: '{command[0]} {command[1]}' failed: {said.read().decode()}")
    return {"seconds": time.monotonic() - begin, "processor_s": usage.ru_utime + usage.ru_stime,
            "peak_MB": usage.ru_maxrss * 1024 / 1e6}


def fit(program, source, out, threads, flags):
    """The same of a fit."""
    return run([program, "fit", source, f"--threads={threads}", f"--out={out}", *flags])


def literal_sweep(program, source, out):
    """Processor seconds of one sweep of the literal AWLS."""
    fit(program, source, out, 1, ["--solver=awls_literal", "--max_iterations=1", "--raw", "--noplots"])
    with (out / "trace.csv").open() as file:
        before, after = (float(row["processor_seconds"]) for row in csv.DictReader(file))
    return {"seconds": after - before, "processor_s": after - before, "peak_MB": None}


def fits(program, merl, rounds, out):
    """A row for each material, way to fit it and number of threads."""
    found = {}
    sources = {material: merl / f"{material}.binary" for material in MATERIALS} | {GONIOMETER.stem: GONIOMETER}
    for number in range(rounds):
        for material, source in sources.items():
            print(f"round {number + 1} of {rounds}: {material}", file=sys.stderr, flush=True)
            if source != GONIOMETER:
                found.setdefault((material, "literal_sweep", 1), []).append(literal_sweep(program, source, out))
            for name, flags in BY_DEFAULT.items():
                for threads in (1, 2):
                    found.setdefault((material, name, threads), []).append(fit(program, source, out, threads, flags))
    for (material, what, threads), times in found.items():
        yield {"material": material, "what": what, "threads": threads, **median(times)}


def samples(program, rounds, out):
    """A row for each number of samples of a stored material in directions at random."""
    random = numpy.random.default_rng(SEED)
    for count in SIZES:
        theta = numpy.degrees(numpy.arccos(random.uniform(0.03, 1, (2, count))))
        rows = numpy.stack([theta[0], 0 * theta[0], theta[1], random.uniform(0, 180, count)], -1)
        at, source = out / "at.csv", out / "samples.csv"
        numpy.savetxt(at, rows, fmt="%.6g", delimiter=",", header="theta_i,phi_i,theta_o,phi_o", comments="")
        run([program, "convert", "material:satin_purple", f"--at={at}", f"--out={source}"])
        print(f"{count} samples", file=sys.stderr, flush=True)
        times = [fit(program, source, out / "fit", 2, BY_DEFAULT["default"]) for _ in range(rounds)]
        yield {"samples": count, "text_MB": source.stat().st_size / 1e6, **median(times)}


def passes(build, rounds):
    """A row for each benchmark: milliseconds and, of readers, MB/s."""
    for program, pattern in (("fit_benchmark", "BM_(ReadAndPrepare|Value|Awls)"), ("read_benchmark", ".")):
        print(program, file=sys.stderr, flush=True)
        done = subprocess.run([build / "benchmarks" / program, f"--benchmark_filter={pattern}",
                               "--benchmark_format=json", f"--benchmark_repetitions={rounds}"],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True)
        for row in json.loads(done.stdout)["benchmarks"]:
            if row.get("aggregate_name") != "median":
                continue
            name = row["run_name"].removeprefix("BM_").split("/iterations:")[0]
            for suffix in ("/real_time", "/manual_time"):
                name = name.removesuffix(suffix)
            name, _, threads = name.partition("/") if program == "fit_benchmark" else (name, "", "1")
            speed = row.get("bytes_per_second")
            yield {"what": name, "threads": threads, "ms": row["real_time"], "MB_per_s": speed and speed / 1e6}


def median(times):
    """The median of each value over rounds."""
    return {key: None if times[0][key] is None else statistics.median(one[key] for one in times) for key in times[0]}


def write(path, rows):
    """A table, with four digits of each number."""
    rows = list(rows)
    with path.open("w") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({key: f"{value:.4g}" if isinstance(value, float) else value for key, value in row.items()})


def main():
    """Runs all, then writes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("merl", type=pathlib.Path, help="a folder of MERL files")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "benchmarks/results")
    options = parser.parse_args()
    program = options.build / "bin/trilobe"
    missing = [name for name in MATERIALS if not (options.merl / f"{name}.binary").exists()]
    if missing:
        sys.exit(f"error: '{options.merl}' has no {missing[0]}.binary")
    busy = os.getloadavg()[0]
    if busy > 0.5:
        print(f"warning: the machine is busy (load {busy:.1f}); wait until it is idle", file=sys.stderr)
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder)
        tables = {"fits": list(fits(program, options.merl, options.rounds, out / "fit")),
                  "samples": list(samples(program, 1, out)), "passes": list(passes(options.build, options.rounds))}
    options.out.mkdir(parents=True, exist_ok=True)
    for name, rows in tables.items():
        write(options.out / f"{name}.csv", rows)
    about = {"revision": machine.revision(), "rounds": options.rounds, **machine.describe()}
    (options.out / "machine.json").write_text(json.dumps(about, indent=1) + "\n")


if __name__ == "__main__":
    main()
