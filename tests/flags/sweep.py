#!/usr/bin/python3
"""Gives every flag of every command a value, and asks that it be heard.

    tests/flags/sweep.py --program=build/release/bin/trilobe [--quick] [NAME...]

Each case is a command on one kind of input: a table, scattered samples, an anisotropic measurement, several
sources, a scene, a model. (`compare`, whose table is of times, has the flags of `plan`.) Each flag that `trilobe help
COMMAND` lists is given another value than its default's, alone. Then one of these must hold:

  - what the command prints or writes differs from that of the command without the flag;
  - the command names the flag in a line of its own: it changes nothing here, or is refused.

SILENT lists the flags that may change nothing, and why. --quick takes the cases without a fit.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

# Another value than its default of each flag; None: not to be given alone.
VALUES = {
    "at": "at.csv", "azimuth": "from_mirror", "bands": "550", "cache": "cache",
    "columns": "theta_i,phi_i,theta_o,phi_o,b,g,r", "convergence": "true", "corrupt": "noise:0.3", "cosine": "1",
    "d_nodes": "8x24", "dark_noise": "true",
    "data_seed": "7", "diagnose": "true", "error": "true", "extrapolated": "true", "f_bins": "8", "force": "true",
    "g_nodes": "4x12", "held_out": "true", "init": "roughness", "json": "true", "lobes": "2",
    "match_reflectance": "false", "rows": "a=b", "max_angle": "60", "max_iterations": "6", "max_parameters": "150",
    "max_seconds": "0.000001", "min_theta_d": "20", "missing": "0.5", "model": "independent", "nocache": "true",
    "nodes": "held_out", "noise": "0.1", "optimality_tolerance": "0.9", "out": None, "outliers": "true",
    "picture": "true", "plots": "true", "prior": "2", "probe": "probe.hdr", "radiometry": "cosine", "raw": "true",
    "reconstruction": "true", "robust": "0.1", "runs": "2", "scale": "2", "scene": None, "seed": "5", "set": None,
    "shard": "1/2", "smoothness": "0.2", "solver": "lm", "solvers": "awls,varpro", "spectral": "true",
    "stretch": "0.2,0.1", "theta_i": "30", "theta_o": "30", "threads": "1", "tilt": "2", "tolerance": "0.5",
    "trace": "model/trace.csv", "verbose": "true", "weighting": "log"}

# Flags that may change nothing, by the beginning of a case's name; "" is every case.
SILENT = {
    "": {"force": "nothing lies in the way", "threads": "results have the same bits for any number",
         "cache": "a fit from the cache is the same", "nocache": "a fit without the cache is the same"},
    "fit": {"seed": "a start by moments and a solver without random starts draw no numbers",
            "smoothness": "tables may be smooth enough", "match_reflectance": "as much light as was measured",
            "raw": "finishing may change nothing", "max_iterations": "it may converge before",
            "tolerance": "it may stop by --max_iterations first"},
    "fit many": {"held_out": "the reports have it"},
    "plan": {"seed": "as of fit", "smoothness": "as of fit", "match_reflectance": "as of fit"},
    "study": {"seed": "as of fit", "smoothness": "as of fit", "match_reflectance": "as of fit",
              "raw": "as of fit", "max_iterations": "as of fit", "tolerance": "as of fit",
              "optimality_tolerance": "AWLS does not know it"},
}

QUICK_FIT = ["--solver=varpro", "--max_iterations=3", "--lobes=1", "--nodiagnose"]
TABLE, SCATTERED, MODEL = "synth:copper@16x16x32", "few.csv", "model/model.json"
# {name: (words, the file or folder in --out, or None)}
FITS = {
    "fit table": (["fit", TABLE, *QUICK_FIT, "--noplots"], "r"),
    "fit scattered": (["fit", SCATTERED, *QUICK_FIT, "--noplots"], "r"),
    "fit anisotropic": (["fit", "synth:linen@4x12", *QUICK_FIT, "--noplots"], "r"),
    "fit many": (["fit", TABLE, "synth:rubber@12x12x24", *QUICK_FIT], "r"),
    "fit scene": (["fit", "--scene=scene.json", *QUICK_FIT[:3], "--nocache"], "r"),
    "study": (["study", TABLE, "--solvers=awls", "--runs=1", *QUICK_FIT[1:]], "r"),
    "plan": (["plan", "scene.json", *QUICK_FIT[:3], "--nocache"], None),
}
OTHERS = {
    "score table": (["score", MODEL, TABLE], None),
    "score scattered": (["score", MODEL, SCATTERED], None),
    "plot": (["plot", MODEL, TABLE], "r"),
    "info table": (["info", TABLE], None),
    "info scattered": (["info", SCATTERED], None),
    "info model": (["info", MODEL], None),
    "convert table": (["convert", TABLE], "x.csv"),
    "convert scattered": (["convert", SCATTERED], "x.csv"),
    "convert model csv": (["convert", MODEL], "x.csv"),
    "convert model glsl": (["convert", MODEL], "x.glsl"),
    "convert model bsdf": (["convert", MODEL], "x.bsdf"),
    "synth": (["synth", "felt@12x12x24"], "x.csv"),
    "view": (["view", MODEL, TABLE], "x.html"),
}
# What a command prints of times, in JSON and in words.
TIMES = r'"\w*seconds\w*": (\{[^}]*\}|[^,\n]*)|seconds .*|\b[0-9.]+ s\b|written .*'
# Files with times, dates and command lines in them count by their being there.
TIMED = {"report.json", "plan.json", "plan.txt", "index.html", "view.html", "fits.csv", "methods.csv", "traces.csv",
         "runs.csv", "run.json", "study.json", "lobes.csv"}


def comparable(path):
    """The content of a file without what differs from run to run."""
    content = path.read_bytes()
    if path.name in TIMED or path.suffix in (".svg", ".pdf"):
        return b""
    if path.suffix == ".json" and b"trilobe-model" in content[:200]:
        model = json.loads(content)
        model.pop("fit")
        return json.dumps(model).encode()
    if path.name == "trace.csv":  # iteration and E
        return b"\n".join(b",".join(line.split(b",")[0:3:2]) for line in content.splitlines())
    return content


class Sweep:
    """Runs commands in a folder of its own."""

    def __init__(self, program, room):
        self.program, self.room = program, pathlib.Path(room)
        self.environment = {**os.environ, "TRILOBE_TEST_LIGHTS": "6", "TRILOBE_TEST_QUIET": "1",
                            "XDG_CACHE_HOME": str(self.room / "none")}

    def run(self, words):
        return subprocess.run([self.program, *words], capture_output=True, text=True, cwd=self.room,
                              env=self.environment, check=False)

    def prepare(self):
        for words in (["convert", "synth:felt@18x18x36", "--missing=0.95", "--out=few.csv"],
                      ["fit", TABLE, *QUICK_FIT, "--noplots", "--out=model"]):
            made = self.run(words)
            if made.returncode:
                sys.exit(f"{' '.join(words)}: {made.stderr}")
        material = {"name": "a", "source": TABLE}
        (self.room / "scene.json").write_text(
            json.dumps({"format": "trilobe-scene", "version": 1, "materials": [material]}))
        (self.room / "at.csv").write_text("theta_i,phi_i,theta_o,phi_o,f\n10,0,20,30,1\n")
        pixels = b"".join(bytes([100, 50 + k % 90, 90, 128]) for k in range(64 * 32))
        (self.room / "probe.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 32 +X 64\n" + pixels)

    def flags_of(self, command):
        return re.findall(r"^  --([a-z_0-9]+)=", self.run(["help", command, "--all"]).stdout, flags=re.MULTILINE)

    def outcome(self, words, out):
        """(exit status, what is printed and written, the lines on stderr)."""
        with tempfile.TemporaryDirectory(dir=self.room) as folder:
            place = pathlib.Path(folder) / out if out else None
            done = self.run([*words, *([f"--out={place}"] if place else [])])
            files = {}
            if place and place.is_dir():
                files = {str(path.relative_to(place)): comparable(path)
                         for path in sorted(place.rglob("*")) if path.is_file()}
            elif place and place.exists():
                files = {"": comparable(place)}
            printed = re.sub(TIMES, "", done.stdout.replace(folder, ""))
            printed = re.sub(r" +", " ", printed)  # columns are as wide as their times
            if words[0] == "plan" or "--scene=scene.json" in words:  # times in the last columns
                printed = re.sub(r"\b[0-9.]+ *$", "", printed, flags=re.MULTILINE)
            return done.returncode, (printed, files), done.stderr.replace(folder, "")

    def heard(self, flag, words, out, base):
        """Whether a flag changes what is made, or is named."""
        kept = [word for word in words if not re.fullmatch(rf"--(no)?{flag}(=.*)?", word)]
        status, made, lines = self.outcome([*kept, f"--{flag}={VALUES[flag]}"], out)
        told = lines.count(f"--{flag}") + made[0].count(f"--{flag}")
        before = base[2].count(f"--{flag}") + base[1][0].count(f"--{flag}")
        if told > before:
            return True
        return status == base[0] and made != base[1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/trilobe")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("cases", nargs="*", help="names of cases, or how they begin")
    options = parser.parse_args()
    program = os.path.realpath(options.program)
    cases = OTHERS if options.quick else {**OTHERS, **FITS}
    wrong = []
    with tempfile.TemporaryDirectory() as room:
        sweep = Sweep(program, room)
        sweep.prepare()
        listed = {command: sweep.flags_of(command) for command in {words[0] for words, _ in cases.values()}}
        for name, (words, out) in cases.items():
            if options.cases and not name.startswith(tuple(options.cases)):
                continue
            unknown = set(listed[words[0]]) - set(VALUES)
            if unknown:
                sys.exit(f"no value for {', '.join(sorted(unknown))}: give each one in {__file__}")
            flags = [flag for flag in listed[words[0]] if VALUES[flag] is not None]
            silent = {flag for begin, of in SILENT.items() if name.startswith(begin) for flag in of}
            base = sweep.outcome(words, out)
            if base[0] or base[1] != sweep.outcome(words, out)[1]:
                sys.exit(f"{name}: fails, or differs from run to run: {base[2]}")
            with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
                heard = pool.map(lambda flag, of=(words, out, base): sweep.heard(flag, *of), flags)
            deaf = [flag for flag, was in zip(flags, heard) if not was and flag not in silent]
            wrong += [f"{name}: --{flag}" for flag in deaf]
            print(f"{name}: {len(flags)} flags" + (f"; in silence: {', '.join(deaf)}" if deaf else ""), flush=True)
    if wrong:
        sys.exit("flags that change nothing, in silence:\n  " + "\n  ".join(wrong))


if __name__ == "__main__":
    main()
