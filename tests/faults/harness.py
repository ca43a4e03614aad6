#!/usr/bin/python3
"""Breaks runs of the real program at every kind of moment, and looks at what is left.

    tests/faults/harness.py --program=build/release/bin/trilobe --trials=400 --seed=1

Each trial draws a command, what lies in its folder before, and a fault: a signal (once or twice, at a
random time or at the very moment when a file appears), a disk that is too small, a folder without write
permission, a gnuplot that is missing, fails or stops half way, a cache whose entries were swapped
or torn, files of others in the place of those that a command writes. After it, these must hold
(docs/reliability.md):

  - a folder holds the files of one run: those of the earlier one, untouched, or those of the new one;
    where there is a report (a plan), all files that it names are there, and no others of the kind;
  - a signal that comes when a model exists leaves that model on disk, unless it was SIGKILL;
  - inputs have the bytes that they had;
  - files that the program has not written have theirs, and the command names one of them, unless it is told
    to --force its way;
  - what went wrong is told in one line, and the exit status is not 0, unless
    only pictures are missing;
  - the same command without the fault succeeds, and leaves no temporary file of any run.
"""

import argparse
import collections
import contextlib
import ctypes
import glob
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import others_files
from others_files import QUICK, Broken, require, snapshot

KEPT = ".previous.json"  # a model of the earlier run, which stays beside the new one
FIT_FILES = {"model.json", "trace.csv", "report.json", "convergence.csv", "reconstruction.binary", "factors.png",
             "slices.png", "spheres.png", "trace.png", "pair.png", "view.html"}
# The pictures, and the score, take a tenth of the time under six lights instead of 600.
ENVIRONMENT = {"TRILOBE_TEST_LIGHTS": "6", "TRILOBE_TEST_QUIET": "1"}
SIGNALS = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL]
# Capabilities that let root read and write what the owner may not: CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH.
OVERRIDES = [1, 2]
PR_CAPBSET_DROP = 24
# How often each is drawn.
FAULTS = {"signal": 10, "signals": 4, "disk": 4, "permission": 1, "gnuplot": 2, "cache": 2, "others' files": 4}
LIBC = ctypes.CDLL(None)


def obey_permissions():
    """Root's next program is held to the permissions of files, as anybody else is anyway."""
    for capability in OVERRIDES:
        LIBC.prctl(PR_CAPBSET_DROP, capability, 0, 0, 0)


def temporaries(folder):
    return glob.glob(os.path.join(glob.escape(folder), "**", ".*trilobe-tmp-*"), recursive=True)


def load(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


class Command:
    """A command that leaves results: its words, its folder, and the check of one result in there."""

    def __init__(self, harness, kind):
        self.kind = kind
        self.out = os.path.join(harness.room, "out")
        if kind == "one":
            self.words = ["fit", harness.source, *QUICK, "--plots", "--reconstruction", f"--out={self.out}"]
            self.earlier = ["fit", "synth:rubber@30x30x60", *QUICK, "--plots", "--convergence", f"--out={self.out}"]
            self.folders = ["."]
        elif kind == "many":
            self.words = ["fit", harness.source, "synth:felt@30x30x60", *QUICK, f"--out={self.out}"]
            self.earlier = ["fit", harness.source, "synth:felt@30x30x60", *QUICK, "--weighting=cosine", f"--out={self.out}"]
            self.folders = ["copper", "felt"]
        else:
            cache = "--cache=" + os.path.join(harness.room, "cache")
            self.words = ["fit", f"--scene={harness.scene}", *QUICK, cache, f"--out={self.out}"]
            self.earlier = ["fit", f"--scene={harness.other_scene}", *QUICK, cache, f"--out={self.out}"]
            self.folders = ["."]

    def result(self, folder):
        """The run that a folder's files belong to, and whether it says that it is complete."""
        path = os.path.join(self.out, folder)
        if not os.path.isdir(path):
            return None, False
        names = {name for name in os.listdir(path) if not name.startswith(".") and not name.endswith(KEPT)}
        if self.kind == "scene":
            runs = {load(os.path.join(path, name))["fit"]["run"]
                    for name in names if name.endswith(".json") and name != "plan.json"}
            seal, known = "plan.json", names
        else:
            names &= FIT_FILES
            runs = {load(os.path.join(path, "model.json"))["fit"]["run"]} if "model.json" in names else set()
            seal, known = "report.json", FIT_FILES
        require(len(runs) <= 1, f"models of {len(runs)} runs in one folder")
        sealed = seal in names
        if sealed:
            report = load(os.path.join(path, seal))
            sealed = "unfinished" not in report
        if sealed:
            require({report["run"]} == runs or not runs, "the report and the model are of two runs")
            require(names & known == set(report["files"]),
                    f"the report names {sorted(report['files'])}, the folder has {sorted(names)}")
        return (next(iter(runs)) if runs else None), sealed

    def check(self, before, dropped):
        """Checks that after a fault each folder holds files of one run. Returns the runs by folder."""
        runs = {}
        now = snapshot(self.out) if os.path.isdir(self.out) else {}
        for folder in self.folders:
            run, sealed = self.result(folder)
            mine = [name for name in now
                    if os.path.dirname(name) == ("" if folder == "." else folder) and not name.endswith(KEPT)]
            if run is not None and run == dropped.get(folder):
                # The earlier result: nothing of the new run may lie beside it.
                for name in mine:
                    if "trilobe-tmp-" not in name and not (name == "plan.json" and not sealed):
                        require(before.get(name) == now[name], f"{name} was changed beside the earlier model")
            else:
                # The new result, or none: nothing of the earlier one may be left.
                for name in mine:
                    require(name not in before or before[name] != now[name] or "trilobe-tmp-" in name,
                            f"{name} of the earlier run lies beside the new model")
            runs[folder] = (run, sealed)
        return runs


class Harness:
    def __init__(self, program, seed, only=None):
        self.program = os.path.abspath(program)
        self.random = random.Random(seed)
        self.only = only
        self.counts = collections.Counter()
        self.skipped = collections.Counter()

    # -- the room in which trials take place --

    @contextlib.contextmanager
    def workshop(self):
        # The program lies where only its owner may enter, as in a clone below /root; spaces do not matter.
        with (tempfile.TemporaryDirectory(prefix="trilobe faults ") as room,
              tempfile.TemporaryDirectory(prefix="trilobe program ") as closed):
            os.chmod(room, 0o755)
            self.base = room
            self.program = shutil.copy(self.program, closed)
            self.source = os.path.join(room, "copper.binary")
            subprocess.run([self.program, "synth", "copper", "--noise=0.02", f"--out={self.source}"], check=True,
                           stdout=subprocess.DEVNULL)
            self.scene = self._scene("scene.json", {"wall": "synth:rubber@30x30x60", "pot": "copper.binary"})
            self.other_scene = self._scene("other.json", {"wall": "synth:felt@30x30x60", "door": "synth:rubber@30x30x60"})
            self.model = os.path.join(room, "model")
            self.succeed(["fit", "synth:felt@12x12x24", *QUICK[:-1], "--noplots", f"--out={self.model}"])
            self.inputs = snapshot(room)
            yield

    def _scene(self, name, sources):
        path = os.path.join(self.base, name)
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"format": "trilobe-scene", "version": 1, "budget": {"relative_rise": 0.05},
                       "directions": {"theta_i": [0, 20], "theta_o": [0, 20]},
                       "materials": [{"name": n, "source": s} for n, s in sources.items()]}, file)
        return path

    def start(self, words, environment=None, obedient=False):
        def prepare():
            for number in SIGNALS[:-1]:
                signal.signal(number, signal.SIG_DFL)
            if obedient:
                obey_permissions()

        return subprocess.Popen([self.program, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                preexec_fn=prepare, text=True,
                                env={**os.environ, **ENVIRONMENT, **(environment or {})})

    def run(self, words, environment=None, obedient=False):
        process = self.start(words, environment, obedient)
        out, err = process.communicate(timeout=300)
        return process.returncode, out, err

    def succeed(self, words):
        status, _, err = self.run(words)
        require(status == 0, f"without a fault: status {status}, {err.strip()}")

    # -- one trial --

    def trial(self):
        fault = self.only or self.random.choices(list(FAULTS), list(FAULTS.values()))[0]
        kind = {"gnuplot": "one", "cache": "scene"}.get(fault) or self.random.choice(["one", "many", "scene"])
        with contextlib.ExitStack() as stack:
            self.room = stack.enter_context(tempfile.TemporaryDirectory(prefix="room-", dir=self.base))
            os.chmod(self.room, 0o777)
            if fault == "others' files":
                self.counts[f"{fault}: {others_files.trial(self)}"] += 1
                self.require_inputs()
                return
            command = Command(self, kind)
            if fault == "disk" and not self.mount(command.out, "64m", stack):
                self.skipped["disk: needs root"] += 1
                return
            before, dropped = {}, {}
            if self.random.random() < 0.6 or fault == "cache":
                self.succeed(command.earlier)
                before = snapshot(command.out)
                dropped = {folder: command.result(folder)[0] for folder in command.folders}
            label = getattr(self, "fault_" + fault)(command, before, dropped, stack)
            self.require_inputs()
            self.succeed(command.words)
            for folder in command.folders:
                require(command.result(folder)[1], "the run after the fault left no complete result")
            require(not temporaries(self.room), f"temporary files are left: {temporaries(self.room)}")
            self.counts[f"{fault}: {label}, {kind}"] += 1

    def require_inputs(self):
        left = snapshot(self.base)
        for name, digest in self.inputs.items():
            require(left.get(name) == digest, f"the input {name} was touched")

    # -- faults: each breaks a run, checks what is particular to it, and returns a name for the table --

    def wait_for_moment(self, process, command):
        """A random time, or as soon as one of the files appears, in its own or a temporary name."""
        if self.random.random() < 0.5:
            time.sleep(self.random.uniform(0, self.random.choice([0.2, 0.6, 1.5])))
            return "at a time"
        folder = os.path.join(command.out, self.random.choice(command.folders))
        seen = snapshot_times(folder)
        skip = self.random.randrange(9)  # so many changes are let pass
        deadline = time.monotonic() + 20
        while process.poll() is None and time.monotonic() < deadline:
            now = snapshot_times(folder)
            if now != seen:
                seen = now
                skip -= 1
                if skip < 0:
                    break
        return "at a file"

    def fault_signal(self, command, before, dropped, _stack):
        number = self.random.choice(SIGNALS)
        process = self.start(command.words)
        moment = self.wait_for_moment(process, command)
        process.send_signal(number)
        _, err = process.communicate(timeout=300)
        runs = command.check(before, dropped)
        name = signal.Signals(number).name
        if number == signal.SIGKILL:
            return f"{name} {moment}"
        require(process.returncode in (0, 128 + number, -number), f"{name}: status {process.returncode}: {err}")
        if process.returncode == -number:
            # Ended by the signal itself: nothing was begun, or all was done.
            for folder, (run, sealed) in runs.items():
                require(sealed or run == dropped.get(folder), f"{name} ended a run that had begun, folder {folder}")
        elif command.kind == "one":
            run, sealed = runs["."]
            require(sealed and run != dropped.get("."), f"{name} was caught, but the model was not kept")
        require(not temporaries(self.room), f"{name} left temporary files")
        return f"{name} {moment}"

    def fault_signals(self, command, before, dropped, _stack):
        numbers = [self.random.choice(SIGNALS[:-1]) for _ in range(self.random.choice([2, 3]))]
        process = self.start(command.words)
        moment = self.wait_for_moment(process, command)
        for number in numbers:
            process.send_signal(number)
            time.sleep(self.random.choice([0, 0.01, 0.2]))
        _, err = process.communicate(timeout=300)
        require(process.returncode == 0 or process.returncode in [128 + n for n in numbers] + [-n for n in numbers],
                f"status {process.returncode}: {err}")
        runs = command.check(before, dropped)
        if process.returncode >= 128 and command.kind == "one":
            require(runs["."][0] not in (None, dropped.get(".")), "a caught signal lost the model")
        return f"{len(numbers)} in a row {moment}"

    def mount(self, path, size, stack):
        """A small disk at `path`; False where this is not allowed."""
        os.makedirs(path, exist_ok=True)
        done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size},mode=777", "tmpfs", path],
                              capture_output=True, check=False)
        if done.returncode != 0:
            return False
        stack.callback(subprocess.run, ["umount", "-l", path], check=False, capture_output=True)
        return True

    def fault_disk(self, command, before, dropped, _stack):
        used = shutil.disk_usage(command.out).used
        free = int(10 ** self.random.uniform(3, 7.6))
        subprocess.run(["mount", "-o", f"remount,size={used + free}", command.out], check=True, capture_output=True)
        status, out, err = self.run(command.words)
        command.check(before, dropped)
        require(not temporaries(command.out), "a full disk leaves temporary files")
        if status == 0:
            label = "enough room"
        else:
            require(status == 1, f"a full disk: status {status}: {err}")
            require("No space left" in err + out, f"a full disk is not told: {err or out}")
            if command.kind == "one":
                require(err.count("\n") == 1, f"a full disk is told in {err.count(chr(10))} lines")
            label = "full"
            if "the model is saved as '" in err:
                saved = err.split("the model is saved as '")[1].split("'")[0]
                require(load(saved)["format"] == "trilobe-model", "the model that was saved elsewhere is none")
                os.remove(saved)
                label = "full, the model saved elsewhere"
        subprocess.run(["mount", "-o", "remount,size=64m", command.out], check=True, capture_output=True)
        return label

    def fault_permission(self, command, before, dropped, _stack):
        os.makedirs(command.out, exist_ok=True)
        os.chmod(command.out, 0o555)
        # Were it found out after the work, it would never be.
        endless = [*command.words, "--max_iterations=1000000", "--tolerance=0", "--max_seconds=1000"]
        status, _, err = self.run(endless, {"HOME": "/nonexistent"}, obedient=True)
        os.chmod(command.out, 0o755)
        require(status == 1 and err.count("\n") == 1 and "Permission denied" in err, f"no permission: {status} {err}")
        require(snapshot(command.out) == before, "something was changed without permission")
        return "read-only folder"

    def fault_gnuplot(self, command, before, dropped, _stack):
        tools = os.path.join(self.room, "tools")
        os.makedirs(tools)
        how, script = self.random.choice([
            ("missing", None), ("fails", "#!/bin/sh\necho no >&2\nexit 1\n"), ("killed", "#!/bin/sh\nkill -9 $$\n"),
            ("half a picture", "#!/bin/sh\nprintf '\\211PNG\\r\\n\\032\\n1234'\n"), ("silent", "#!/bin/sh\nexit 0\n")])
        if script is not None:
            path = os.path.join(tools, "gnuplot")
            with open(path, "w", encoding="utf-8") as file:
                file.write(script)
            os.chmod(path, 0o755)
        status, _, err = self.run(command.words, {"PATH": tools + (":/bin" if script else "")})
        require(status == 0 and err.count("\n") == 1 and "gnuplot" in err, f"gnuplot {how}: {status} {err}")
        run, sealed = command.check(before, dropped)["."]
        require(sealed and run != dropped.get("."), "without pictures the rest must be there")
        return how

    def fault_cache(self, command, before, dropped, _stack):
        self.succeed(command.words)
        expected = {name: load(os.path.join(command.out, name))["D"] for name in ("wall.json", "pot.json")}
        shutil.rmtree(command.out)
        entries = sorted(glob.glob(os.path.join(self.room, "cache", "*.cache")))
        require(entries, "nothing was cached")
        how = self.random.choice(["swapped", "torn", "emptied", "edited"])
        one, other = self.random.sample(entries, 2)
        if how == "swapped":
            shutil.copy(one, other)
        elif how == "torn":
            os.truncate(one, self.random.randrange(os.path.getsize(one)))
        elif how == "emptied":
            os.truncate(one, 0)
        else:
            with open(one, "r+b") as file:
                file.seek(self.random.randrange(os.path.getsize(one)))
                file.write(b"7")
        self.succeed(command.words)
        for name, table in expected.items():
            require(load(os.path.join(command.out, name))["D"] == table, f"{name} has another material's model")
        return how


def snapshot_times(folder):
    """Names and times of what is in a folder: cheap enough to be asked thousands of times a second."""
    try:
        with os.scandir(folder) as entries:
            return {entry.name: entry.stat(follow_symlinks=False).st_mtime_ns for entry in entries}
    except OSError:
        return {}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/trilobe")
    parser.add_argument("--trials", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="begin with this trial, to repeat one that failed")
    parser.add_argument("--fault", choices=FAULTS, help="no other than this")
    options = parser.parse_args()
    harness = Harness(options.program, options.seed, options.fault)
    # Started in the background of a script, it would ignore Ctrl-C; stopped, it prints what it has.
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    failures = done = 0
    with harness.workshop(), contextlib.suppress(KeyboardInterrupt):
        for k in range(options.first, options.first + options.trials):
            harness.random = random.Random(f"{options.seed}/{k}")
            try:
                harness.trial()
            except (Broken, OSError, ValueError, KeyError, subprocess.SubprocessError) as error:
                failures += 1
                print(f"trial {k}: {type(error).__name__}: {error}", flush=True)
            done += 1
            if sys.stderr.isatty():
                print(f"\r\033[K{k + 1 - options.first} of {options.trials} trials", end="", file=sys.stderr)
    if sys.stderr.isatty():
        print("\r\033[K", end="", file=sys.stderr)
    for what, count in sorted(harness.counts.items()):
        print(f"{count:5}  {what}")
    for why, count in harness.skipped.items():
        print(f"{count:5}  skipped: {why}")
    print(f"{done} trials with seed {options.seed}: {failures} broke a promise")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
