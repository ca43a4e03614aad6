"""Statistics of runs. A value that is missing or was never reached is infinite: it is counted."""
import math
import statistics

import numpy


def quantile(values, q):
    """The smallest value that at least a share q of them do not exceed; nan of none.

    No interpolation: between a finite value and infinity there is nothing to interpolate.
    """
    ordered = sorted(values)
    return ordered[max(0, math.ceil(q * len(ordered)) - 1)] if ordered else math.nan


def median(values):
    return quantile(values, 0.5)


def geometric_mean(values):
    return math.exp(statistics.fmean(math.log(value) for value in values)) if values else math.nan


def excess(objective, best):
    """(E - E*) / E*; where E* is 0, 0 or infinite."""
    if best == 0:
        return 0.0 if objective == 0 else math.inf
    return max(0.0, objective / best - 1)


def time_to_target(times, objectives, target):
    """The first time at which the objective is at most the target; infinite if never."""
    return next((t for t, value in zip(times, objectives) if value <= target), math.inf)


def best_so_far(values):
    """The running minimum."""
    return numpy.minimum.accumulate(numpy.asarray(values, dtype=float))


def value_at(times, values, when):
    """The last value at or before each time of `when`; infinite before the first. [len(when)]"""
    index = numpy.searchsorted(times, when, side="right") - 1
    return numpy.where(index >= 0, numpy.asarray(values, dtype=float)[index], math.inf)


def data_profile(times, at):
    """Share of problems that are solved after each time of `at` (Moré and Wild 2009, in seconds
    instead of evaluations). times: one a problem, infinite if never."""
    ordered = numpy.sort(numpy.asarray(times, dtype=float))
    return numpy.searchsorted(ordered, at, side="right") / len(ordered)


def performance_ratios(times):
    """{solver: [time over the least of any solver, one a problem]} (Dolan and Moré 2002).

    times: {solver: [one a problem, infinite if never]}. A problem that none solves is infinite for
    all.
    """
    least = [min(of) for of in zip(*times.values())]
    return {solver: [t / b if math.isfinite(t) else math.inf for t, b in zip(of, least)]
            for solver, of in times.items()}


def linear_rate(excesses, last=20):
    """The factor by which the excess falls an iteration near the end: exp of the least-squares slope
    of log excess over the last iterations with an excess above 0; nan with fewer than three."""
    logs = [math.log(value) for value in excesses if value > 0][-last:]
    if len(logs) < 3:
        return math.nan
    return math.exp(numpy.polyfit(range(len(logs)), logs, 1)[0])


def order(excesses):
    """Order of convergence near the end: the median of log(e2/e1) / log(e1/e0) over the last five
    triples of strictly falling excess; nan if there is none."""
    orders = [math.log(c / b) / math.log(b / a)
              for a, b, c in zip(excesses, excesses[1:], excesses[2:]) if a > b > c > 0]
    return statistics.median(orders[-5:]) if orders else math.nan
