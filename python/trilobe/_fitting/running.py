"""A fit in a thread of its own, so that the one that asked for it hears Ctrl-C whatever C++ does."""

from __future__ import annotations

import os
import queue
import threading
from collections.abc import Callable
from typing import Any, Protocol

from trilobe._fitting.extension import fits
from trilobe._fitting.result import Record
from trilobe._model.brdf import Brdf
from trilobe._model.error import Error

_POLL_SECONDS = 0.05

Callback = Callable[[Record, Brdf], Any]


class Stop(Protocol):
    """A flag such as threading.Event, which another thread sets to end a fit."""

    def is_set(self) -> bool:
        """Whether the fit is to end."""
        ...


def run(
    fit: Callable[[Any, Callable[[Any, bytes], bool] | None], Any],
    source: str,
    callback: Callback | None = None,
    stop: Stop | None = None,
    progress: bool = True,
) -> Any:
    """What `fit` returns, of a RunningFit and what asks after each iteration whether to stop.

    `callback` is called in this thread, and the fit waits for it. The bar names `source`.
    """
    try:
        shows_bar = bool(progress)
    except (TypeError, ValueError):  # an array of several numbers has no truth value
        raise Error("progress must be True or False", kind="format", key="progress") from None
    running = fits().RunningFit()
    ended: dict[str, Any] = {}
    done = threading.Event()  # join() forgets the thread when Ctrl-C ends it
    asked: queue.Queue[tuple[Any, bytes]] = queue.Queue()
    answers: queue.Queue[bool] = queue.Queue()
    left = threading.Event()

    def ask(record: Any, text: bytes) -> bool:
        if left.is_set():
            return True
        asked.put((record, text))
        return answers.get()

    def work() -> None:
        try:
            ended["outcome"] = fit(running, None if callback is None else ask)
        except BaseException as error:
            ended["error"] = error
        finally:
            done.set()

    def answer() -> None:
        """Calls back; whatever is raised there ends the fit, and is raised when that has ended."""
        try:
            record, text = asked.get(timeout=_POLL_SECONDS)
        except queue.Empty:
            return
        answered = True
        try:
            assert callback is not None
            answered = bool(callback(Record(*record), Brdf.from_json(text.decode(), "the model so far")))
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            ended.setdefault("raised", error)
        finally:
            answers.put(answered)

    thread = threading.Thread(target=work, name="trilobe.fit", daemon=True)
    bar = _Bar(shows_bar, source)
    stopped = False
    thread.start()
    try:
        while not done.is_set():
            try:
                if callback is None:
                    done.wait(_POLL_SECONDS)
                else:
                    answer()
                bar.show(*running.latest())
                if stop is not None and stop.is_set():
                    running.stop()
            except KeyboardInterrupt:
                running.stop()
                if stopped:
                    raise
                stopped = True
    finally:
        left.set()
        answers.put(True)  # to one that asks just now
        running.stop()
        bar.close()
    for name in ("raised", "error"):
        if name in ended:
            raise ended[name]
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
        """Moves the bar to so many records, and shows the E of the last one."""
        if self._bar is not None and count > self._count:
            self._bar.set_postfix_str(f"E {objective:.4g}", refresh=False)
            self._bar.update(count - self._count)
            self._count = count

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
