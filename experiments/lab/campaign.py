"""Runs units one after the other: what is there is kept, what fails is told and left out."""
import statistics
import sys
import time

from lab.units import UnitFailed


def duration(seconds):
    """12 s, 7 min, 2.5 h."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def distinct(units):
    """The units without repetitions, in their order."""
    return list({unit.key: unit for unit in units}.values())


def shard_of(units, i, n):
    """The i-th of n parts, i from 1: every n-th unit, those that need a unit beside that one."""
    roots = {}
    return [unit for unit in units if roots.setdefault(unit.root.key, len(roots)) % n == i - 1]


def _kind(unit):
    return unit.path.rsplit("/", 1)[-1]


class _TimeLeft:
    """Time left for the units to come: each takes as long as those of its kind have taken, or else as all have."""

    def __init__(self, store, units):
        self._taken = {}
        for unit in units:
            if record := store.record(unit):
                self.add(unit, record["seconds"])

    def add(self, unit, seconds):
        self._taken.setdefault(_kind(unit), []).append(seconds)

    def of(self, units):
        """Text, empty if nothing is known yet."""
        everything = [seconds for taken in self._taken.values() for seconds in taken]
        if not units or not everything:
            return ""
        left = sum(statistics.fmean(self._taken.get(_kind(unit), everything)) for unit in units)
        return f"; about {duration(left)} left"


def run(store, units, again=False, out=None):
    """Makes the units. Returns the lines of those that failed.

    Progress and an estimate of the time left go to `out`, standard error if it is None. It can be
    stopped at any time, and goes on where it was when it is run again.
    """
    out = out or sys.stderr
    units = distinct(units)
    left = [unit for unit in units if again or not store.is_done(unit)]
    known = len(units) - len(left)
    if known:
        print(f"{known} of {len(units)} units are there already", file=out, flush=True)
    time_left = _TimeLeft(store, units)
    failures, failed = [], {}
    for done in range(len(left)):
        unit, begin = left[done], time.monotonic()
        print(f"[{known + done + 1}/{len(units)}] {unit.path}", end=" ", file=out, flush=True)
        try:
            store.make(unit, again, failed)
            seconds = time.monotonic() - begin
            time_left.add(unit, seconds)
            outcome = f"{seconds:.1f} s"
        except UnitFailed as failure:
            failures.append(str(failure))
            outcome = f"failed: {failure}"
        print(outcome + time_left.of(left[done + 1:]), file=out, flush=True)
    return failures
