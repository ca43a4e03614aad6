"""Fixtures for tests of shaders and pages: the program, models of every form, and a browser. They skip where Playwright
(PyPI) or Debian's chromium is not there."""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

Open = Callable[..., Any]
REPOSITORY = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("TRILOBE_BUILD", REPOSITORY / "build/release"))
# WebGL 2 without a graphics card.
SOFTWARE = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]


def run(*arguments: str | Path) -> str:
    """Runs trilobe and returns what it prints; its own error line is that of the test."""
    command = [str(BUILD / "bin/trilobe"), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{' '.join(command)}: {done.stderr}"
    return done.stdout


def wait_for(page: Any, expression: str, seconds: float = 60) -> None:
    """Waits until the expression is true. Playwright's wait_for_function is an eval, which pages do not allow."""
    end = time.monotonic() + seconds
    while not page.evaluate(expression):
        assert time.monotonic() < end, f"not within {seconds} s: {expression}"
        page.wait_for_timeout(20)


@pytest.fixture(scope="session")
def launch() -> Iterator[Callable[[list[str]], Any]]:
    """Starts a browser with these flags."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    chromium = shutil.which("chromium")
    if chromium is None:
        pytest.skip("chromium is not installed")
    with playwright.sync_playwright() as started:
        yield lambda flags: started.chromium.launch(executable_path=chromium, args=flags)


@pytest.fixture(scope="session")
def browser(launch: Callable[[list[str]], Any]) -> Iterator[Any]:
    launched = launch(SOFTWARE)
    yield launched
    launched.close()


@pytest.fixture(scope="session")
def browser_without_webgl(launch: Callable[[list[str]], Any]) -> Iterator[Any]:
    launched = launch(["--disable-3d-apis"])
    yield launched
    launched.close()


@pytest.fixture(scope="session")
def fits(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two fits, each in a folder with its pair.png: out/plastic and out/shot_silk."""
    out = tmp_path_factory.mktemp("fits") / "out"
    run("fit", "synth:plastic", "synth:shot_silk", "--solver=awls", "--max_iterations=3", f"--out={out}")
    return out


def models(folder: Path, fits: Path) -> dict[str, Path]:
    """Models of every form by name, made of a fitted one."""
    plastic = json.loads((fits / "plastic/model.json").read_text())
    made: dict[str, dict[str, Any]] = {"fitted": plastic}
    stretched = dict(plastic, version=2, stretch={"along": -0.3, "across": 0.2})
    made["stretched"] = stretched
    made["stretched_by_lobe"] = dict(
        plastic,
        version=2,
        stretch=[
            {"along": -0.3, "across": 0.2},
            {"along": 0.4, "across": 0.0},
            {"along": -0.3, "across": 0.2},
        ],
    )
    # F for each lobe, D for each channel, G shared by all.
    shaded = [[value * (1 - 0.3 * c) for value in plastic["D"][0]] for c in range(3)]
    made["other_sharing"] = dict(
        plastic,
        D=[[[v * (1 + 0.1 * m) for v in row] for row in shaded] for m in range(3)],
        F=[plastic["F"]] * 3,
        G=plastic["G"][0],
        sharing={
            "D": {"per_lobe": True, "per_channel": True},
            "F": {"per_lobe": True, "per_channel": True},
            "G": {"per_lobe": False, "per_channel": False},
        },
    )
    made["thinned"] = dict(
        plastic,
        F=[{"size": 90, "nodes": [0, 40, 80], "values": [row[0], row[40], row[80]]} for row in plastic["F"]],
    )
    made["five_lobes"] = dict(
        plastic,
        lobes=5,
        s=[*plastic["s"], *plastic["s"][:2]],
        D=[*plastic["D"], *plastic["D"][1:]],
        G=[*plastic["G"], *plastic["G"][:2]],
    )
    made["lambertian"] = {
        key: plastic[key] for key in ("format", "version", "kind")
    } | {"lobes": 0, "d": [0.1, 0.2, 0.3], "s": [], "D": [], "F": [], "G": []}
    paths = {}
    for name, model in made.items():
        model.pop("unobserved", None)
        paths[name] = folder / f"{name}.json"
        paths[name].write_text(json.dumps(model))
    paths["anisotropic"] = fits / "shot_silk/model.json"
    return paths


@pytest.fixture(scope="session")
def pages(fits: Path) -> dict[str, Path]:
    """A page of each fit beside its measurement, and one of the model alone."""
    made = {}
    for name in ("plastic", "shot_silk"):
        made[name] = fits / name / "page.html"
        run("view", fits / name / "model.json", f"synth:{name}", f"--out={made[name]}",
            f"--trace={fits / name / 'trace.csv'}")
    made["coarse"] = fits / "plastic/coarse.html"
    run("view", fits / "plastic/model.json", "synth:plastic@24x30x12", f"--out={made['coarse']}")
    made["alone"] = fits / "plastic/alone.html"
    run("view", fits / "plastic/model.json", f"--out={made['alone']}")
    return made


@pytest.fixture
def open_page(browser: Any, pages: dict[str, Path]) -> Iterator[Open]:
    """Opens a page in a state, waits for its finished picture, and fails for any complaint on the console."""
    complaints: list[str] = []
    contexts = []

    def opened(name: str, size: tuple[int, int] = (1200, 800), scheme: str = "light", size_of_picture: int = 64,
               **state: Any) -> Any:
        context = browser.new_context(
            viewport={"width": size[0], "height": size[1]}, color_scheme=scheme, accept_downloads=True)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda m: complaints.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        text = base64.urlsafe_b64encode(json.dumps({"size": size_of_picture, **state}).encode()).decode().rstrip("=")
        page.goto(f"file://{pages[name]}#{text}")
        finished(page)
        return page

    yield opened
    for context in contexts:
        context.close()
    # Drivers' remarks on their own speed are not the page's.
    own = [text for text in complaints if "GPU stall due to ReadPixels" not in text]
    assert own == []


def finished(page: Any, seconds: float = 60) -> None:
    wait_for(page, "window.trilobe?.renderer?.shown && !trilobe.renderer.pending", seconds)


def picture(page: Any, side: int) -> npt.NDArray[np.float64]:
    """The light of the fitted (0) or measured (1) object, row by row, with its exposure."""
    numbers, size, exposure = page.evaluate(
        f"(() => {{ const r = trilobe.renderer; return [Array.from(r.numbersOf(r.shown, {side})), r.shown.size,"
        " r.exposure]; })()")
    return np.array(numbers).reshape(size, size, 4)[..., :3] * exposure
