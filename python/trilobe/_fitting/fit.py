"""Fits: the program's, to the bit, in a thread of their own."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from numpy.typing import ArrayLike

from trilobe._fitting.extension import fits
from trilobe._fitting.measurement import Measurement, measurement_of
from trilobe._fitting.objective import Problem
from trilobe._fitting.options import (
    Form,
    InitName,
    SolverName,
    SolverOptions,
    Weights,
    stretch_text,
    weights_of,
    without_none,
)
from trilobe._fitting.result import Result
from trilobe._fitting.running import Callback, Stop, run
from trilobe._model.brdf import Brdf, model_of
from trilobe._model.error import Error
from trilobe._model.files import text_of_path

if TYPE_CHECKING:
    from typing_extensions import Unpack


def fit(
    measurement: Measurement | str | os.PathLike[str],
    model: Form = "shared",
    solver: SolverName = "auto",
    *,
    lobes: int | None = None,
    stretch: ArrayLike | None = None,
    d_nodes: str | None = None,
    g_nodes: str | None = None,
    f_bins: int | None = None,
    nodes: Literal["auto", "given", "held_out"] = "auto",
    init: InitName = "analytic",
    start: Brdf | str | os.PathLike[str] | None = None,
    weighting: str = "appearance",
    weights: Weights | None = None,
    prior: float | None = None,
    robust: float = 0,
    smoothness: float = 0.005,
    match_reflectance: bool = True,
    raw: bool = False,
    max_parameters: int | None = None,
    seed: int = 1,
    threads: int = 0,
    progress: bool = True,
    callback: Callback | None = None,
    stop: Stop | None = None,
    **solver_options: Unpack[SolverOptions],
) -> Result:
    """Fits a model to a measurement, as `trilobe fit` does: the same options give the same bits.

    Ctrl-C ends it with the best model so far; a second one gives that up, too. Other Python threads run.

    Args:
        measurement: a `Measurement`, or what `read` takes.
        model: the form (docs/model.md, docs/forms.md).
        solver: a name of `solvers()`.
        lobes: how many; 3 by default, of "independent" 1.
        stretch: (along, across) of isotropic models, once or for each lobe.
        d_nodes: of anisotropic models, the nodes of D, as "12rx36".
        g_nodes: the nodes of G, as "6x24".
        f_bins: the bins of F.
        nodes: "held_out" chooses those of D and G by directions that are held out.
        init: a name of `initial_models()`.
        start: a model to start from, or the file of one or material:NAME, whose form the fit then has.
        weighting: a name of `weightings()`, or "power:...".
        weights: a factor of the weight of each sample, (n,) as the rows of `measurement.rho`, those of samples that
            are not valid for nothing; or a function of wi, wo and rho, each (n, 3), that returns it. With
            weighting="uniform" they are the whole weight. A table that is weighted is judged as samples are, and
            the light that it reflects is not mended.
        prior: of scattered samples, how much a small model counts between them.
        robust: above 0, a loss that is linear in the error beyond this.
        smoothness: by which share E may rise for the smoothest tables, where that is not seen; 0: the least E.
        match_reflectance: whether the light that is reflected is mended after the fit.
        raw: the model that the solver found, without what follows by default; for comparing solvers.
        max_parameters: of model="auto", how many the model may store; by default as many as the default form.
        seed: of whatever is random.
        threads: 0 for all cores. The result does not depend on it.
        progress: shows a bar, where tqdm is installed.
        callback: called after each iteration with a `Record` and the model so far, in this thread, while the fit
            waits. If it returns true, the fit ends with the best model so far; what it raises ends the fit, too. Of
            model="auto" the first form alone calls it.
        stop: a threading.Event, or what else has `is_set()`; when another thread sets it, the fit ends likewise.
        **solver_options: as `max_iterations`, `max_seconds`; `solvers()` says what each solver takes. When
            `max_seconds` are over since the call, the fit ends with the best model so far and without what would
            follow the solver. It takes longer by what is under way, as by the iteration, and by the comparison
            with the measurement (report["seconds"]["score"]).

    Raises:
        Error: with the program's line.
        KeyboardInterrupt: when it is interrupted before there is a model.
    """
    form_is_given = lobes is not None or stretch is not None or not isinstance(model, str) or model != "shared"
    if start is not None and form_is_given:
        raise Error("start brings its own lobes and tables; leave out model, lobes and stretch")
    options = {
        "model": model,
        "nodes": nodes,
        "solver": solver,
        "init": init,
        "weighting": weighting,
        "robust": robust,
        "smoothness": smoothness,
        "match_reflectance": match_reflectance,
        "raw": raw,
        "seed": seed,
        "threads": threads,
    } | without_none(
        lobes=lobes,
        stretch=stretch_text(stretch),
        d_nodes=d_nodes,
        g_nodes=g_nodes,
        f_bins=f_bins,
        start=None if start is None else model_of(start).to_json().encode(),
        prior=prior,
        max_parameters=max_parameters,
    )
    data = measurement_of(measurement)
    if callback is not None and not callable(callback):
        raise Error("callback must be a function of a record and a model")
    if stop is not None and not callable(getattr(stop, "is_set", None)):
        raise Error("stop must be a threading.Event, or have is_set()")
    by_sample = weights_of(weights, data)
    outcome = run(
        lambda running, ask: fits().fit(data._data, options, {**solver_options}, running, by_sample, ask),
        data.source, callback, stop, progress,
    )
    if not outcome.begun:
        if stop is not None and stop.is_set():
            raise Error("the fit was stopped before there was a model")
        raise KeyboardInterrupt
    return Result(outcome, Problem(data, weighting, by_sample, threads))


def score(
    model: Brdf | str | os.PathLike[str],
    measurement: Measurement | str | os.PathLike[str],
    *,
    weighting: str = "appearance",
    threads: int = 0,
) -> dict[str, Any]:
    """Compares a model with a measurement; what `trilobe score --json` prints (docs/file-formats.md)."""
    brdf = model_of(model)
    data = measurement_of(measurement)
    text = fits().score(brdf.to_json().encode(), data._data, {"weighting": weighting, "threads": threads})
    report: dict[str, Any] = json.loads(text)
    return report


class LobeMatch(NamedTuple):
    """The likeness of two models' lobes, as `match_lobes` returns it."""

    agreement: float
    """The mean match of all lobes of both, weighted by the light that they reflect; 1: the same."""
    lobe: list[int]
    """Which lobe of the model each lobe of the reference is; -1 where the model has fewer."""
    match: list[float]
    """How alike the two are, from 0 to 1."""


def match_lobes(reference: Brdf | str | os.PathLike[str], model: Brdf | str | os.PathLike[str]) -> LobeMatch:
    """Pairs the lobes of two models of one form, and says how alike they are (docs/study.md#the-same-lobes)."""
    texts = [model_of(value).to_json().encode() for value in (reference, model)]
    return LobeMatch(*fits().match_lobes(*texts))


class Solver(NamedTuple):
    """Description of a solver."""

    name: str
    description: str
    reference: str
    """Where the method is from."""
    options: dict[str, tuple[Any, str]]
    """Keyword arguments of `fit`, with their defaults and what they mean."""


def solvers() -> list[Solver]:
    """All solvers, the default one first (docs/solvers.md)."""
    return [Solver(*entry) for entry in fits().solvers()]


def initial_models() -> dict[str, str]:
    """Names of starting points, the default one first, and what they are."""
    return dict(fits().initial_models())


def weightings() -> dict[str, str]:
    """Names of weightings of the objective, the default one first, and what they are."""
    return dict(fits().weightings())


def synthetic_materials() -> list[str]:
    """Names for "synth:NAME"."""
    return list(fits().synthetic_materials())


def fit_many(
    sources: Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    *,
    workers: int = 0,
    program: str | os.PathLike[str] | None = None,
    **flags: Any,
) -> list[dict[str, Any]]:
    """Fits many measurements side by side, by the program's batch (docs/batch.md).

    Each goes into a folder of its name in `out`, which `load` reads; what is there already, of the same
    measurement and flags, is not fitted again.

    Args:
        sources: files, folders of them, or synth:NAME.
        out: the folder to write into.
        workers: threads to use; 0 for all cores.
        program: the `trilobe` to run; by default the one beside this Python, or on the PATH.
        **flags: of `trilobe fit`, as solver="awls", max_iterations=5, plots=True.

    Returns:
        The rows of fits.csv, numbers as floats: a table for pandas.DataFrame.
    """
    from trilobe._fitting.batch import run

    return run([text_of_path(source) for source in _listed(sources)], text_of_path(out), workers, program, flags)


def _listed(sources: Any) -> list[Any]:
    if isinstance(sources, (str, bytes, os.PathLike)):
        return [sources]
    try:
        return list(sources)
    except TypeError:
        raise Error("sources must be a list of paths") from None
