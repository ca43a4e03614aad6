"""Units of work: one command that fills one folder, made once whoever asks for it.

A unit's folder carries a hash of the exact command and of the bytes of the program and of the files
that it is given, so results of other settings, programs or data never mix, and experiments that ask
for the same command share its folder. A command works in a temporary folder beside it, which is
renamed when all of it is there: a folder that exists is whole. Folders of several machines can be
copied together: there is nothing to merge.
"""
import dataclasses
import datetime
import functools
import glob
import hashlib
import json
import os
import pathlib
import resource
import shutil
import signal
import socket
import subprocess
import sys
import time

from lab import machine

FOLDER = "{folder}"  # in an argument: the folder to fill


@dataclasses.dataclass(frozen=True)
class Product:
    """A file that another unit makes, as an argument: that unit is made first."""

    unit: "Unit"
    file: str


@dataclasses.dataclass(frozen=True)
class Unit:
    """One command. Units are equal if they have the same command and program."""

    path: str  # readable place in the store, "fit/chrome/awls"; the same for the same command
    program: pathlib.Path
    arguments: tuple  # str, which may hold FOLDER, and Product
    product: str = "stdout.txt"  # the file without which the command has failed
    timeout_s: float | None = None
    modules: tuple = ()  # paths of files that the program reads besides, whose bytes count
    # Labels of the unit in its experiment, {"material": "chrome", "solver": "awls"}; not in its key.
    labels: dict = dataclasses.field(default_factory=dict, compare=False)

    @functools.cached_property
    def program_sha256(self):
        return file_hash(self.program)

    @functools.cached_property
    def key(self):
        """Hash of the command and of the bytes of the program and of the files that the command
        names, by which these count wherever they lie; those of needed units among them."""
        parts = [self.path, self.program_sha256, self.product]
        for argument in self.arguments:
            if isinstance(argument, Product):
                parts.append([argument.unit.key, argument.file])
            else:
                parts.append(_with_hash(argument))
        parts += [file_hash(module) for module in self.modules]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()

    @property
    def needs(self):
        """The units whose products are arguments of this one."""
        return [a.unit for a in self.arguments if isinstance(a, Product)]

    @property
    def root(self):
        """The first unit that has to be made for this one: itself if it needs none."""
        return self.needs[0].root if self.needs else self


@functools.lru_cache(maxsize=None)
def _hash_of_file(path, size, mtime_ns):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def file_hash(path):
    """SHA-256 of a file's bytes."""
    status = os.stat(path)
    return _hash_of_file(str(path), status.st_size, status.st_mtime_ns)


def _with_hash(argument):
    """FILE and FLAG=FILE with the hash of the file's bytes in its place, others as they are. A file
    has a / in its name: a word that happens to be one, too, is none."""
    before, equals, after = argument.rpartition("=")
    for start, path in (("", argument), (before + equals, after)):
        if os.sep in path and os.path.isfile(path):
            return [start, file_hash(path)]
    return argument


def _processor_seconds():
    """Processor time of all commands that have ended, on all processors, whatever else ran."""
    of = resource.getrusage(resource.RUSAGE_CHILDREN)
    return of.ru_utime + of.ru_stime


def _interpreted(words):
    """A command with this Python before a Python script, whatever interpreter that names."""
    with open(words[0], "rb") as program:
        first = program.readline(200)
    return [sys.executable, *words] if first.startswith(b"#!") and b"python" in first else words


class UnitFailed(Exception):
    """A command that failed; its one line says which and how."""


class Store:
    """The folders of all units under one root."""

    def __init__(self, root):
        self.root = pathlib.Path(root)

    def folder(self, unit):
        """The folder of a unit, there or not."""
        return self.root / f"{unit.path}-{unit.key[:12]}"

    def is_done(self, unit):
        return self.folder(unit).is_dir()

    def record(self, unit):
        """The record of a unit: command, seconds, machine. None if it is not made."""
        try:
            return json.loads((self.folder(unit) / "unit.json").read_text())
        except FileNotFoundError:
            return None

    def failure(self, unit):
        """Why a unit failed when it was last tried, or None."""
        try:
            return json.loads(self._failure_file(unit).read_text())
        except FileNotFoundError:
            return None

    def make(self, unit, again=False, failed=None):
        """Makes a unit and what it needs, unless they are there. Returns its folder.

        With `again` the unit itself is made anew. Raises UnitFailed, and leaves a record of that.
        failed: {key: line} of units that are not tried again; this adds to it.
        """
        failed = {} if failed is None else failed
        if unit.key in failed:
            raise UnitFailed(failed[unit.key])
        try:
            return self._make(unit, again, failed)
        except UnitFailed as failure:
            failed[unit.key] = str(failure)
            raise

    def _make(self, unit, again, failed):
        for needed in unit.needs:
            try:
                self.make(needed, failed=failed)
            except UnitFailed as failure:
                raise UnitFailed(f"{unit.path} needs {failure}") from None
        folder = self.folder(unit)
        if folder.is_dir() and not again:
            return folder
        folder.parent.mkdir(parents=True, exist_ok=True)
        self._remove_torn(folder)
        part = folder.with_name(f".{folder.name}.part-{socket.gethostname()}-{os.getpid()}")
        part.mkdir()
        try:
            record = self._run(unit, part)
            (part / "unit.json").write_text(json.dumps(record, indent=1) + "\n")
            if again:
                shutil.rmtree(folder, ignore_errors=True)
            try:
                part.rename(folder)
            except OSError:
                if not folder.is_dir():  # another process may have made the same unit meanwhile
                    raise
        finally:
            shutil.rmtree(part, ignore_errors=True)
        self._failure_file(unit).unlink(missing_ok=True)
        return folder

    def command(self, unit, folder):
        """The words of the command that fills this folder."""
        words = [str(unit.program)]
        for argument in unit.arguments:
            if isinstance(argument, Product):
                words.append(str(self.folder(argument.unit) / argument.file))
            else:
                words.append(argument.replace(FOLDER, str(folder)))
        return words

    def _run(self, unit, folder):
        if file_hash(unit.program) != unit.program_sha256:
            raise UnitFailed(f"{unit.path}: {unit.program} has changed since this run began")
        words = self.command(unit, folder)
        # Should this process be killed, the kernel ends the command too.
        guard = ["setpriv", "--pdeathsig", "KILL"] if shutil.which("setpriv") else []
        begin, used = time.monotonic(), _processor_seconds()
        with open(folder / "stdout.txt", "wb") as out, open(folder / "stderr.txt", "wb") as err:
            # A session of its own: Ctrl-C comes here alone, or the command would end as if done.
            process = subprocess.Popen(guard + _interpreted(words), stdin=subprocess.DEVNULL,
                                       stdout=out, stderr=err, start_new_session=True)
            try:
                status = process.wait(timeout=unit.timeout_s)
            except subprocess.TimeoutExpired:
                status = f"no end after {unit.timeout_s:g} s"
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
        seconds, used = time.monotonic() - begin, _processor_seconds() - used
        if status == 0 and not (folder / unit.product).exists():
            status = f"did not write {unit.product}"
        if status != 0:
            said = (folder / "stderr.txt").read_text(errors="replace").strip().splitlines()
            self._failure_file(unit).write_text(json.dumps(
                {"command": words, "status": status, "seconds": seconds, "stderr": said[-20:]},
                indent=1) + "\n")
            how = f"exit status {status}" if isinstance(status, int) else status
            raise UnitFailed(f"{unit.path}: {how}" + (f": {said[-1]}" if said else ""))
        return {"command": self.command(unit, FOLDER), "program_sha256": unit.program_sha256,
                "revision": machine.revision(),
                "seconds": round(seconds, 3), "processor_seconds": round(used, 3),
                "finished": datetime.datetime.now(datetime.timezone.utc).isoformat("T", "seconds"),
                "machine": machine.describe()}

    def _failure_file(self, unit):
        folder = self.folder(unit)
        return folder.with_name(folder.name + ".failed.json")

    @staticmethod
    def _remove_torn(folder):
        """Removes what processes that are no more left of this unit on this machine."""
        prefix = f".{folder.name}.part-{socket.gethostname()}-"
        for part in folder.parent.glob(glob.escape(prefix) + "*"):
            pid = part.name.removeprefix(prefix)
            if pid == str(os.getpid()) or (pid.isdigit()
                                           and not pathlib.Path(f"/proc/{pid}").exists()):
                shutil.rmtree(part, ignore_errors=True)
