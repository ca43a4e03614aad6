"""The result of a fit."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._fitting.extension import fits
from trilobe._fitting.measurement import Measurement, measurement_of
from trilobe._fitting.objective import Objective, Problem
from trilobe._fitting.statistics import Statistics, objective_of, report_of, statistics_of
from trilobe._fitting.uncertainty import MOST, Uncertainty, uncertainty
from trilobe._model.brdf import Brdf
from trilobe._model.error import Error
from trilobe._model.files import make_folder, printable, text_of_path, write_text
from trilobe._model.pictures import page, plots

_FOUND = {
    "converged": "an iteration changed E by less than the tolerance",
    "optimal": "the gradient is at most the tolerance",
    "exact_fit": "E is at the rounding error of the data",
    "no_decrease": "no step lowers E any more",
}
_ENDED = {
    "max_iterations": "max_iterations is reached",
    "max_seconds": "max_seconds is over",
    "interrupted": "interrupted",
}
_STATUS = {"max_iterations": 1, "max_seconds": 2, "interrupted": 3}
_KEYS = (
    "x", "fun", "jac", "success", "status", "message", "nit", "nfev", "njev", "model", "report", "trace",
)
_NO_DATA = "a Result that was unpickled has no measurement; give measurement="


class Record(NamedTuple):
    """The state of a fit after an iteration: a row of `Result.trace`, with its names."""

    iteration: int
    seconds: float
    objective: float
    filtered: bool
    accepted: bool
    step: float
    optimality: float
    processor_seconds: float
    objective_with_prior: float


class Result(Mapping[str, Any]):
    """The result of a fit.

    Attributes:
        model: the fitted `Brdf`, in canonical form.
        trace: a structured array, a row an iteration, with the columns of trace.csv: iteration, seconds,
            objective, filtered, accepted, step, optimality, processor_seconds, objective_with_prior (NaN: unknown).
        report: a dict, as report.json is (docs/file-formats.md).
        interrupted: whether Ctrl-C, `callback` or `stop` ended it early; a limit as `max_seconds` does not count.
        x: the parameters of the model, in the order of `Objective.parts`. [n]
        nfev: how often E was computed, from the starting points to the finishing steps, traces included.
        njev: how often its derivatives by all parameters were; sweeps of awls compute those of a part at a time.

    Names of scipy.optimize.OptimizeResult are there, too, as attributes and as keys (``result["fun"]``): `x`, `fun`,
    `jac`, `success`, `status`, `message`, `nit`, `nfev`, `njev`. Those of lmfit's results are attributes: `chisqr`,
    `redchi`, `aic`, `bic`, `ndata`, `nvarys`, `nfree`, `residual`, and `fit_report()`. What needs the measurement
    (`jac` and these) raises Error in a Result that was unpickled.
    """

    model: Brdf
    trace: NDArray[np.void]
    report: dict[str, Any]
    interrupted: bool
    x: NDArray[np.float64]
    nfev: int
    njev: int

    def __init__(self, outcome: Any, problem: Problem) -> None:
        """Takes what C++ returned, and what it was asked."""
        self._problem: Problem | None = problem
        self.x = outcome.parameters()
        self.model = Brdf.from_json(outcome.model_text.decode(), "the fitted model")
        columns = {
            name: values.astype(bool) if name in ("filtered", "accepted") else values
            for name, values in outcome.trace().items()
        }
        rows = len(columns["iteration"])
        self.trace = np.empty(rows, [(name, values.dtype) for name, values in columns.items()])
        for name, values in columns.items():
            self.trace[name] = values
        self.interrupted = outcome.interrupted
        self._texts = {
            "model.json": self.model.to_json(),
            "trace.csv": outcome.trace_text,
            "report.json": outcome.report_text.decode(),
        }
        self.report = json.loads(self._texts["report.json"])
        self.nfev = int(outcome.values)
        self.njev = int(outcome.derivatives)
        self._objective: Objective | None = None

    @property
    def verdict(self) -> str:
        """The visible difference between the model and its measurement, in words."""
        verdict: str = self.report["verdict"]["words"]
        return verdict

    @property
    def fun(self) -> float:
        """E of the model, on the measured samples alone."""
        return float(self.report["objective"])

    @property
    def success(self) -> bool:
        """Whether the solver found what it looks for, and no limit ended it."""
        return not self.interrupted and self.report["stop_reason"] in _FOUND

    @property
    def message(self) -> str:
        """Why the fit ended (docs/solvers.md#stopping)."""
        reason: str = "interrupted" if self.interrupted else self.report["stop_reason"]
        return _FOUND.get(reason) or _ENDED[reason]

    @property
    def nit(self) -> int:
        """Iterations of the solver."""
        return int(self.report["iterations"])

    @property
    def status(self) -> int:
        """0 where `success` is true, 1 for max_iterations, 2 for max_seconds, 3 for an interruption."""
        return 0 if self.success else _STATUS["interrupted" if self.interrupted else self.report["stop_reason"]]

    @property
    def jac(self) -> NDArray[np.float64]:
        """The gradient of E at x. [n] It is 0 or more where x is 0 and would leave its bound."""
        return self._E().gradient(self.x)

    @property
    def residual(self) -> NDArray[np.float64]:
        """sqrt(w) (model - measurement) by sample and channel, whose squares add up to `fun`. [3 samples]."""
        return self._E().residuals(self.x)

    @property
    def ndata(self) -> int:
        """How many residuals there are: three of each sample."""
        return self._statistics().ndata

    @property
    def nvarys(self) -> int:
        """How many parameters the data hold: what they read and is not at 0, but for the scale of each table."""
        return self._statistics().nvarys

    @property
    def nfree(self) -> int:
        """`ndata` - `nvarys`."""
        return self._statistics().nfree

    @property
    def chisqr(self) -> float:
        """`fun`, whose weights are those of the weighting and not 1 / sigma^2: it compares fits with one weighting."""
        return self.fun

    @property
    def redchi(self) -> float:
        """`chisqr` / `nfree`."""
        return self._statistics().redchi

    @property
    def aic(self) -> float:
        """Akaike's information criterion, n ln(chisqr / n) + 2 nvarys, as lmfit has it."""
        return self._statistics().aic

    @property
    def bic(self) -> float:
        """The Bayesian information criterion, n ln(chisqr / n) + ln(n) nvarys."""
        return self._statistics().bic

    def fit_report(self, *, show_correl: bool = True, min_correl: float = 0.1) -> str:
        """The statistics, d and s by name with their deviations, and how far the tables are off, as lmfit has it.

        Deviations are those of `uncertainty()`; "fixed" is an entry that no sample reads, or that is at 0.

        Args:
            show_correl: tells correlations among d and s, too.
            min_correl: those that are smaller are left out.
        """
        told = self.uncertainty() if len(self.x) <= MOST else None
        lines = {
            "measurement": str(self.report["source"]),
            "fitting method": str(self.report["solver"]),
            "iterations": f"{self.nit}",
            "function evals": f"{self.nfev}",
            "message": self.message,
            "verdict": self.verdict,
        }
        return report_of(lines, self._statistics(), self.model, told, float(min_correl) if show_correl else None)

    def _E(self) -> Objective:
        """The E that `fun` is of."""
        if self._objective is None:
            if self._problem is None or self._problem.measurement is None:
                raise Error("a Result that was unpickled has no measurement; fit again, or take trilobe.Objective",
                            kind="missing", key="measurement")
            self._objective = objective_of(self._problem, self.model)
        return self._objective

    def _statistics(self) -> Statistics:
        return statistics_of(self._E(), self.x, self.fun)

    def __getitem__(self, name: str) -> Any:
        """An attribute that is a key, as ``result["fun"]``."""
        if name not in _KEYS:
            raise KeyError(name)
        return getattr(self, name)

    def __iter__(self) -> Iterator[str]:
        """The keys; `jac` only where it can be computed."""
        has_data = self._problem is not None and self._problem.measurement is not None
        return (name for name in _KEYS if name != "jac" or has_data)

    def __len__(self) -> int:
        """The number of keys."""
        return sum(1 for _ in self)

    def __eq__(self, other: object) -> bool:
        """Whether it is the same object, as arrays have no truth value."""
        return self is other

    __hash__ = object.__hash__

    def uncertainty(
        self,
        method: Literal["covariance", "bootstrap"] = "covariance",
        *,
        replicates: int = 30,
        blocks: int = 90,
        seed: int = 1,
        measurement: Measurement | str | os.PathLike[str] | None = None,
    ) -> Uncertainty:
        """Standard deviations of d, s and the tables, by the data alone, without a prior.

        The scale of each table is held, as it can move to s without a change of the BRDF: its mean, with weights
        by how firmly the data hold its entries. Entries at 0 are held, too.

        Args:
            method: "covariance" is s^2 (J'J)^-1, where s^2 is the mean square of the residuals. It is right where
                residuals are independent, as noise is, and too small where the form of the model is the limit.
                "bootstrap" draws blocks of samples anew, and takes a Gauss-Newton step from the fit for each; so it
                counts what residuals nearby have in common.
            replicates: of the bootstrap. Each takes about as long as an iteration.
            blocks: of the bootstrap, by how many a block grid divides theta_h and theta_d each.
            seed: of the bootstrap.
            measurement: what was fitted, for a Result that was unpickled, and has it no longer.

        Raises:
            Error: for more than 4000 parameters, or if there is no measurement.
        """
        problem = self._problem
        if measurement is not None:
            problem = Problem(measurement_of(measurement), *(problem or Problem(None))[1:])
        if problem is None or problem.measurement is None:
            raise Error(_NO_DATA, kind="missing", key="measurement")
        return uncertainty(problem, self.model, method, replicates, blocks, seed)

    def __getstate__(self) -> dict[str, Any]:
        """All but the measurement, which may be large."""
        problem = self._problem and self._problem._replace(measurement=None)
        return {**self.__dict__, "_problem": problem, "_objective": None}

    def save(self, folder: str | os.PathLike[str], *, force: bool = False) -> None:
        """Writes model.json, trace.csv and report.json into a folder, which is made if need be.

        Another model that is there stays as model.previous.json, as `trilobe fit` has it.

        Raises:
            Error: if they cannot be written or, without ``force``, one of them exists that Trilobe has not written.
        """
        name = Path(text_of_path(folder))
        if not force:
            for file in self._texts:
                _check_own(name / file)
        make_folder(name)
        _keep_earlier(name / "model.json", self._texts["model.json"])
        for file, text in self._texts.items():
            write_text(name / file, text)

    def __repr__(self) -> str:
        """The verdict."""
        return f"<trilobe.Result: {self.verdict}>"

    def _repr_html_(self) -> str:
        """The verdict, numbers and pictures, as notebooks show them."""
        plot = plots()
        rows = {
            "measurement": str(self.report["source"]),
            "E": f"{self.fun:.4g}",
            "iterations": f"{self.nit} of {self.report['solver']}; {self.message}",
            "evaluations of E": f"{self.nfev}",
            "parameters": f"{len(self.x)}",
        }
        measurement = self._problem.measurement if self._problem is not None else None

        def spheres(figure: Any) -> None:
            try:
                plot.spheres(self.model, measurement, figure)
            except Error:  # samples on no grid make no picture
                plot.spheres(self.model, None, figure)

        drawings = {
            "D, F and G of the fitted model":
                (*plot.size_of_factors(self.model), lambda figure: plot.factors(self.model, figure)),
            "the measurement and the fitted model on a sphere": (6.4, 3.4, spheres),
        }
        return page(self.verdict, rows, drawings)


def _check_own(path: Path) -> None:
    """Raises Error if there is a file that Trilobe has not written."""
    try:
        content = path.read_bytes() if path.exists() else b""
    except OSError as error:
        raise Error(f"cannot read {printable(path)}: {error.strerror}") from None
    if content and not fits().says_own(content):
        raise Error(
            f"{printable(path)} exists, and Trilobe has not written it; move it away, give another folder, or "
            "overwrite it by force=True"
        )


def _keep_earlier(path: Path, text: str) -> None:
    try:
        if path.exists() and path.read_bytes() != text.encode("utf-8", "surrogatepass"):
            path.replace(path.with_name("model.previous.json"))
    except OSError as error:
        raise Error(f"cannot keep the earlier '{path}': {error.strerror}") from None
