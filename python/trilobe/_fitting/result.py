"""The result of a fit."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from trilobe._fitting.extension import fits
from trilobe._fitting.measurement import Measurement, measurement_of
from trilobe._fitting.objective import Problem
from trilobe._fitting.uncertainty import Uncertainty, uncertainty
from trilobe._model.brdf import Brdf
from trilobe._model.error import Error
from trilobe._model.files import make_folder, printable, text_of_path, write_text

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


class Result:
    """The result of a fit.

    Attributes:
        model: the fitted `Brdf`, in canonical form.
        trace: a structured array, a row an iteration, with the columns of trace.csv: iteration, seconds,
            objective, filtered, accepted, step, optimality, processor_seconds, objective_with_prior (NaN: unknown).
        report: a dict, as report.json is (docs/file-formats.md).
        interrupted: whether Ctrl-C, `callback` or `stop` ended it early; a limit as `max_seconds` does not count.
        x: the parameters of the model, in the order of `Objective.parts`. [n]

    Names of scipy.optimize.OptimizeResult are there, too: `x`, `fun`, `success`, `message`, `nit`, `nfev`.
    """

    model: Brdf
    trace: NDArray[np.void]
    report: dict[str, Any]
    interrupted: bool
    x: NDArray[np.float64]

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
    def nfev(self) -> int:
        """Points at which the trace has E: the start, and one an iteration."""
        return len(self.trace)

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
            raise Error("a Result that was unpickled has no measurement; give measurement=")
        return uncertainty(problem, self.model, method, replicates, blocks, seed)

    def __getstate__(self) -> dict[str, Any]:
        """All but the measurement, which may be large."""
        problem = self._problem and self._problem._replace(measurement=None)
        return {**self.__dict__, "_problem": problem}

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
