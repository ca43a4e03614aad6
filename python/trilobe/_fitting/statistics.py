"""What statistics say of a fit, as users of SciPy and lmfit know it: chi-squared, information criteria, a report."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._fitting.objective import Objective, Problem
from trilobe._fitting.uncertainty import MOST, Uncertainty
from trilobe._model.brdf import CHANNELS, Brdf


class Statistics(NamedTuple):
    """Numbers that lmfit's MinimizerResult has, by its names."""

    ndata: int
    """Residuals: three of each sample."""
    nvarys: int
    """Parameters that data hold: those that samples read and that are not at 0, but for the scale of each table."""
    chisqr: float
    """E, the sum of squared residuals [in the units of the weighting]."""

    @property
    def nfree(self) -> int:
        """Degrees of freedom."""
        return self.ndata - self.nvarys

    @property
    def redchi(self) -> float:
        """chisqr / nfree; NaN where none is free."""
        return self.chisqr / self.nfree if self.nfree > 0 else float("nan")

    @property
    def aic(self) -> float:
        """Akaike's information criterion, for a variance that is not known: n ln(chisqr / n) + 2 nvarys."""
        return self._twice_log() + 2 * self.nvarys

    @property
    def bic(self) -> float:
        """The Bayesian one, n ln(chisqr / n) + ln(n) nvarys."""
        return self._twice_log() + float(np.log(self.ndata)) * self.nvarys

    def _twice_log(self) -> float:
        return self.ndata * float(np.log(max(self.chisqr / self.ndata, 1e-250)))


def objective_of(problem: Problem, model: Brdf) -> Objective:
    """The E that a fit reports: of the measured samples alone, in the form of the model."""
    assert problem.measurement is not None
    weights = None
    if problem.weights is not None:
        valid = problem.measurement.valid
        weights = np.zeros(len(valid))
        weights[valid] = problem.weights
    return Objective(
        problem.measurement, like=model, weighting=problem.weighting, weights=weights, threads=problem.threads)


def statistics_of(E: Objective, x: NDArray[np.float64], chisqr: float) -> Statistics:
    """The statistics of a model whose E is chisqr."""
    free = E.observed & (x > 0)
    tables = sum(bool(free[part].any()) for name, part in E.parts.items() if name not in ("d", "s"))
    return Statistics(3 * E.num_samples, max(int(free.sum()) - tables, 0), chisqr)


def report_of(
    lines: dict[str, str], statistics: Statistics, model: Brdf, told: Uncertainty | None, min_correl: float | None
) -> str:
    """The text of `Result.fit_report`; `lines` are what it begins with, by their names."""
    lines = {
        **lines,
        "data points": f"{statistics.ndata}",
        "variables": f"{statistics.nvarys}",
        "chi-square": f"{statistics.chisqr:.8g}",
        "reduced chi-square": f"{statistics.redchi:.8g}",
        "Akaike info crit": f"{statistics.aic:.8g}",
        "Bayesian info crit": f"{statistics.bic:.8g}",
    }
    text = ["[[Fit Statistics]]", *(f"    {name:<18} = {value}" for name, value in lines.items())]
    text.append("[[Variables]]")
    numbers = _numbers(model, told)
    width = max(len(name) for name, _, _ in numbers)
    text += [f"    {name + ':':<{width + 1}} {_with_deviation(value, off)}" for name, value, off in numbers]
    text += [f"    {line}" for name in "DFG" for line in _tables(model, name, told)]
    if told is None:
        text.append(f"    (deviations are computed of at most {MOST} parameters)")
    elif min_correl is not None:
        text.append(f"[[Correlations]] (unreported correlations are < {min_correl:.3f})")
        text += [f"    C({a}, {b}) = {c:+.4f}" for a, b, c in correlations(model, told, min_correl)]
    return "\n".join(text)


def correlations(model: Brdf, told: Uncertainty, least: float) -> list[tuple[str, str, float]]:
    """Pairs among d and s that are correlated by so much or more, by their names, the most correlated first."""
    names = [name for name, _, _ in _numbers(model, told)]
    count = len(names)  # d and s are the first of x
    covariance, deviation = told.covariance[:count, :count], told.x[:count]
    pairs = []
    for a in range(count):
        for b in range(a + 1, count):
            if 0 < deviation[a] < np.inf and 0 < deviation[b] < np.inf:
                value = float(covariance[a, b] / (deviation[a] * deviation[b]))
                if abs(value) >= least:
                    pairs.append((names[a], names[b], value))
    return sorted(pairs, key=lambda pair: -abs(pair[2]))


def _numbers(model: Brdf, told: Uncertainty | None) -> list[tuple[str, float, float | None]]:
    """(name, value, deviation) of d and s, in the order of the parameters."""
    found: list[tuple[str, float, float | None]] = []
    for c, channel in enumerate(CHANNELS):
        found.append((f"d[{channel}]", float(model.d[c]), None if told is None else float(told.d[c])))
    for m in range(model.lobes):
        for c, channel in enumerate(CHANNELS):
            off = None if told is None else float(told.s[m, c])
            found.append((f"s[{m}, {channel}]", float(model.s[m, c]), off))
    return found


def _with_deviation(value: float, off: float | None) -> str:
    if off is None:
        return f"{value:.8g}"
    if off == 0:
        return f"{value:.8g} (fixed)"
    if np.isinf(off):
        return f"{value:.8g} +/- inf"
    return f"{value:.8g} +/- {off:.4g} ({100 * off / value:.2f}%)"


def _tables(model: Brdf, name: str, told: Uncertainty | None) -> list[str]:
    """A line for each table of a factor: how many entries it has, and how far these are off."""
    table = getattr(model, name)
    if model.lobes == 0:
        return []
    of_lobe, of_channel = (int("lobe" in table.dims), int("channel" in table.dims))
    lines = []
    for at in np.ndindex(table.shape[: of_lobe + of_channel]):
        labels = [str(at[0])] * of_lobe + [CHANNELS[at[-1]]] * of_channel
        values = np.asarray(table[at]).ravel()
        line = f"{name}[{', '.join(labels)}]: {values.size} entries"
        if told is not None:
            off = np.asarray(getattr(told, name)[at]).ravel()
            known = (off > 0) & np.isfinite(off)
            if known.any():
                line += f", +/- {100 * np.median(off[known] / values[known]):.2g}% in the median"
            line += "".join(f", {int(count)} {what}" for count, what in (
                ((off == 0).sum(), "fixed"), (np.isinf(off).sum(), "+/- inf")) if count)
        lines.append(line)
    return lines
