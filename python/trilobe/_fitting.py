"""Fits: the program's, to the bit, in a thread of their own."""

from __future__ import annotations

import json
import os
import re
import threading
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from trilobe._arrays import as_array
from trilobe._brdf import Brdf, model_of, text_of_path, write_text
from trilobe._core import Error
from trilobe._measurement import Measurement, fits, measurement_of

_POLL_SECONDS = 0.05


class Result:
    """What a fit has come to.

    Attributes:
        model: the fitted `Brdf`, in canonical form.
        trace: a structured array, a row an iteration, with the columns of trace.csv: iteration, seconds,
            objective, filtered, accepted, step, optimality, processor_seconds, objective_with_prior (NaN: unknown).
        report: a dict, as report.json is (docs/file-formats.md).
        interrupted: whether Ctrl-C ended it early.
    """

    model: Brdf
    trace: NDArray[np.void]
    report: dict[str, Any]
    interrupted: bool

    def __init__(self, outcome: Any) -> None:
        """Takes what C++ returned."""
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
        """What a person would see of the model beside its measurement."""
        verdict: str = self.report["verdict"]["words"]
        return verdict

    def save(self, folder: str | os.PathLike[str]) -> None:
        """Writes model.json, trace.csv and report.json into a folder, which is made if need be.

        Another model that is there stays as model.previous.json, as `trilobe fit` has it.
        """
        name = Path(text_of_path(folder))
        try:
            name.mkdir(parents=True, exist_ok=True)
        except (OSError, ValueError) as error:
            raise Error(f"cannot make the folder '{name}': {getattr(error, 'strerror', None) or error}") from None
        _keep_earlier(name / "model.json", self._texts["model.json"])
        for file, text in self._texts.items():
            write_text(name / file, text)

    def __repr__(self) -> str:
        """The verdict."""
        return f"<trilobe.Result: {self.verdict}>"


def _keep_earlier(path: Path, text: str) -> None:
    try:
        if path.exists() and path.read_bytes() != text.encode("utf-8", "surrogatepass"):
            path.replace(path.with_name("model.previous.json"))
    except OSError as error:
        raise Error(f"cannot keep the earlier '{path}': {error.strerror}") from None


def fit(
    measurement: Measurement | str | os.PathLike[str],
    model: Literal["shared", "isotropic", "anisotropic", "independent", "auto"] = "shared",
    solver: str = "auto",
    *,
    lobes: int | None = None,
    stretch: ArrayLike | None = None,
    d_nodes: str | None = None,
    g_nodes: str | None = None,
    f_bins: int | None = None,
    nodes: Literal["given", "held_out"] = "given",
    init: str = "analytic",
    start: Brdf | str | os.PathLike[str] | None = None,
    weighting: str = "appearance",
    prior: float | None = None,
    robust: float = 0,
    smoothness: float = 0.005,
    match_reflectance: bool = True,
    raw: bool = False,
    max_parameters: int | None = None,
    seed: int = 1,
    threads: int = 0,
    progress: bool = True,
    **solver_options: Any,
) -> Result:
    """Fits a model to a measurement, as `trilobe fit` does: the same options give the same bits.

    Ctrl-C ends it with the best model so far; a second one gives that up, too. Other Python threads run.

    Args:
        measurement: a `Measurement`, or what `read` takes.
        model: the form (docs/model.md, docs/model-choice.md).
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
        prior: of scattered samples, how much a small model counts between them.
        robust: above 0, a loss that is linear in the error beyond this.
        smoothness: by which share E may rise for the smoothest tables, where that is not seen; 0: the least E.
        match_reflectance: whether the light that is reflected is mended after the fit.
        raw: the model that the solver found, without what follows by default; for comparing solvers.
        max_parameters: of model="auto", how many the model may store; by default as many as the default form.
        seed: of whatever is random.
        threads: 0 for all cores. The result does not depend on it.
        progress: shows a bar, where tqdm is installed.
        **solver_options: as `max_iterations`, `max_seconds`; `solvers()` says what each solver takes.

    Raises:
        Error: with the program's line.
        KeyboardInterrupt: when it is interrupted before there is a model.
    """
    form = form_options(model, lobes, stretch, d_nodes, g_nodes, f_bins, nodes)
    if start is not None and (lobes is not None or form["stretch"] or not isinstance(model, str) or model != "shared"):
        raise Error("start brings its own lobes and tables; leave out model, lobes and stretch")
    options = form | {
        "solver": solver,
        "init": init,
        "start": None if start is None else model_of(start).to_json().encode(),
        "weighting": weighting,
        "prior": prior,
        "robust": robust,
        "smoothness": smoothness,
        "match_reflectance": match_reflectance,
        "raw": raw,
        "max_parameters": max_parameters,
        "seed": seed,
        "threads": threads,
    }
    data = measurement_of(measurement)
    outcome = _run(data, options, solver_options, bool(progress))
    if not outcome.begun:
        raise KeyboardInterrupt
    return Result(outcome)


def form_options(
    model: str,
    lobes: int | None,
    stretch: ArrayLike | None,
    d_nodes: str | None,
    g_nodes: str | None,
    f_bins: int | None,
    nodes: str,
) -> dict[str, Any]:
    """The form of a model, as C++ takes it. Raises Error."""
    pairs: list[list[float]] = []
    if stretch is not None:
        array = as_array(stretch, "stretch").astype(np.float64)
        if array.ndim not in (1, 2) or array.shape[-1] != 2:
            raise Error("stretch must be (along, across), once or for each lobe")
        pairs = array.reshape(-1, 2).tolist()
    if not isinstance(nodes, str) or nodes not in ("given", "held_out"):
        raise Error(f"unknown nodes {' '.join(repr(nodes).split())[:60]}; known: given, held_out")
    return {
        "model": model,
        "lobes": lobes,
        "stretch": [tuple(pair) for pair in pairs],
        "d_nodes": _nodes_of("d_nodes", d_nodes),
        "g_nodes": _nodes_of("g_nodes", g_nodes),
        "f_bins": f_bins,
        "nodes_by_held_out": nodes == "held_out",
    }


def _nodes_of(name: str, text: Any) -> tuple[int, bool, int] | None:
    if text is None:
        return None
    match = re.fullmatch(r"(\d{1,4})(r?)x(\d{1,4})", text) if isinstance(text, str) else None
    if match is None or (match[2] and name == "g_nodes"):
        given = " ".join(repr(text).split())[:60]
        raise Error(f"{name}={given} are no nodes; give theta x phi, as '6x48'")
    return int(match[1]), bool(match[2]), int(match[3])


def _run(data: Measurement, options: dict[str, Any], solver_options: dict[str, Any], progress: bool) -> Any:
    """Fits in a thread, so that this one hears Ctrl-C whatever C++ does."""
    module = fits()
    running = module.RunningFit()
    ended: dict[str, Any] = {}
    done = threading.Event()  # as join() forgets the thread when Ctrl-C ends it

    def work() -> None:
        try:
            ended["outcome"] = module.fit(data._data, options, solver_options, running)
        except BaseException as error:
            ended["error"] = error
        finally:
            done.set()

    thread = threading.Thread(target=work, name="trilobe.fit", daemon=True)
    bar = _Bar(progress, data.source)
    stopped = False
    thread.start()
    try:
        while not done.is_set():
            try:
                done.wait(_POLL_SECONDS)
                bar.show(*running.latest())
            except KeyboardInterrupt:
                running.stop()
                if stopped:
                    raise
                stopped = True
    finally:
        bar.close()
    if "error" in ended:
        raise ended["error"]
    return ended["outcome"]


class _Bar:
    """tqdm's, where it is installed and wanted."""

    def __init__(self, wanted: bool, name: str) -> None:
        self._bar: Any = None
        self._count = 0
        if wanted:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            self._bar = tqdm(desc=f"fit {os.path.basename(name)}", unit="it", leave=False)

    def show(self, count: int, iteration: int, seconds: float, objective: float) -> None:
        """How many records there have been, and what the last one says."""
        if self._bar is not None and count > self._count:
            self._bar.set_postfix_str(f"E {objective:.4g}", refresh=False)
            self._bar.update(count - self._count)
            self._count = count

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()


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


class Solver(NamedTuple):
    """What can be said of a solver."""

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
    """What "synth:NAME" may name."""
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
    from trilobe._batch import run

    return run([text_of_path(source) for source in _listed(sources)], text_of_path(out), workers, program, flags)


def _listed(sources: Any) -> list[Any]:
    if isinstance(sources, (str, bytes, os.PathLike)):
        return [sources]
    try:
        return list(sources)
    except TypeError:
        raise Error("sources must be a list of paths") from None
