"""Statistics of runs. A value that is missing or was never reached is infinite: it is counted."""
import itertools
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
    """The middle value, of an even number the mean of the two in the middle; nan of none. It is infinite where one of
    the two is: not more than half of the runs have got there."""
    return statistics.median(values) if len(values) else math.nan


def spread(values, outside):
    """(low, median, high): a share `outside` of the values lies beyond either end; all nan of none."""
    return quantile(values, outside), median(values), quantile(values, 1 - outside)


def geometric_mean(values):
    return math.exp(statistics.fmean(math.log(value) for value in values)) if values else math.nan


def ratio(value, least):
    """value / least; where that is 0, 1 or infinite. What is infinite, as missing, stays so."""
    if math.isinf(value):
        return math.inf
    if value == least:
        return 1.0
    return value / least if least > 0 else math.inf


def excess(objective, best):
    """(E - E*) / E*; where E* is 0, 0 or infinite."""
    return max(0.0, ratio(objective, best) - 1)


def time_to_target(times, objectives, target):
    """The first time at which the objective is at most the target; infinite if never."""
    return next((t for t, value in zip(times, objectives) if value <= target), math.inf)


def bootstrap(values, statistic, draws=2000, level=0.95, seed=1):
    """(low, high): the percentile interval of statistic(values) over samples of the same size with replacement
    (Efron and Tibshirani 1993, chapter 13). statistic takes a list."""
    random = numpy.random.default_rng(seed)
    of = sorted(statistic([values[i] for i in random.integers(len(values), size=len(values))]) for _ in range(draws))
    return quantile(of, (1 - level) / 2), quantile(of, (1 + level) / 2)


def sign_test(first, second, tolerance):
    """(how often the first of a pair is lower, how often the second, p): pairs within `tolerance` of each other,
    relatively, count for neither; p is two-sided, of the binomial distribution with chance 1/2."""
    lower = sum(a < b / (1 + tolerance) for a, b in zip(first, second))
    higher = sum(b < a / (1 + tolerance) for a, b in zip(first, second))
    n = lower + higher
    tail = sum(math.comb(n, k) for k in range(min(lower, higher) + 1)) / 2 ** n
    return lower, higher, min(1.0, 2 * tail)


def crossed(rows, factors, narrowed, key):
    """(array of row[key], a level of each factor an axis, in the order of the rows; the levels of the factor `narrowed`
    that have a row with every combination of the others', and are those of its axis)."""
    values = {tuple(row[factor] for factor in factors): row[key] for row in rows}
    levels = {factor: list(dict.fromkeys(row[factor] for row in rows)) for factor in factors}
    levels[narrowed] = [level for level in levels[narrowed]
                        if all(of in values for of in itertools.product(*({**levels, narrowed: [level]}.values())))]
    cube = numpy.array([values[of] for of in itertools.product(*levels.values())], dtype=float)
    return cube.reshape([len(of) for of in levels.values()]), levels[narrowed]


def variance_shares(cube, factors):
    """Shares of the variance of cube [a level of each factor an axis], every combination once, by analysis of variance:
    {("solver",): of one factor alone, ("material", "solver"): of what the two do together and none alone, ...}, every
    choice of factors. They add up to 1; all nan if the cube is constant."""
    cube = numpy.asarray(cube, dtype=float)
    axes = range(cube.ndim)
    chosen = [of for count in axes for of in itertools.combinations(axes, count + 1)]
    means = {of: cube.mean(axis=tuple(axis for axis in axes if axis not in of), keepdims=True) for of in [(), *chosen]}
    squares = {}
    for of in chosen:  # inclusion and exclusion
        part = sum((-1) ** (len(of) - len(smaller)) * means[smaller] for smaller in means if set(smaller) <= set(of))
        squares[tuple(factors[axis] for axis in of)] = float(numpy.sum(numpy.broadcast_to(part, cube.shape) ** 2))
    total = sum(squares.values())
    return {of: square / total if total > 0 else math.nan for of, square in squares.items()}


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


# Relative decreases of E below this are the rounding of a sum over a million samples.
ROUNDING = 1e-13


def linear_rate(decreases, last=20):
    """The factor by which the decrease an iteration shrinks near the end: exp of the least-squares
    slope of the logarithm of the last positive decreases; nan with fewer than three.

    Where E - limit falls by a constant factor, its decreases fall by the same, and the limit need
    not be known.
    """
    logs = [math.log(value) for value in decreases if value > 0][-last:]
    if len(logs) < 3:
        return math.nan
    return math.exp(numpy.polyfit(range(len(logs)), logs, 1)[0])


def order(decreases):
    """Order of convergence near the end: the median of log(c/b) / log(b/a) over the last five
    triples of strictly falling decreases; nan if there is none. 1: linear, 2: quadratic."""
    orders = [math.log(c / b) / math.log(b / a)
              for a, b, c in zip(decreases, decreases[1:], decreases[2:]) if a > b > c > 0]
    return statistics.median(orders[-5:]) if orders else math.nan


def rank_correlation(a, b):
    """Spearman's: the correlation of ranks, which equal values share; nan of values that are all alike."""
    def ranks(values):
        _, places, counts = numpy.unique(values, return_inverse=True, return_counts=True)
        return (numpy.cumsum(counts) - (counts - 1) / 2)[places]
    return float(numpy.corrcoef(ranks(a), ranks(b))[0, 1]) if min(len(set(a)), len(set(b))) > 1 else math.nan
