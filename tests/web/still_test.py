"""A page without WebGL 2: all but the turning picture is there, and the picture is what the page holds."""

from __future__ import annotations

import base64
import io
import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from conftest import Open, wait_for


@pytest.fixture
def open_still(browser_without_webgl: Any) -> Iterator[Callable[..., Any]]:
    """Opens a file without WebGL, and fails for any complaint on the console."""
    complaints: list[str] = []
    contexts = []

    def opened(path: Path, size: tuple[int, int] = (1280, 800)) -> Any:
        context = browser_without_webgl.new_context(viewport={"width": size[0], "height": size[1]})
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda m: complaints.append(m.text) if m.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: complaints.append(str(error)))
        page.goto(f"file://{path}")
        wait_for(page, "window.trilobe?.page?.renderer?.isStill && !trilobe.page.chartsStale")
        return page

    yield opened
    for context in contexts:
        context.close()
    # The test's own reading of pixels is remarked on.
    assert [text for text in complaints if "willReadFrequently" not in text] == []


def pixel(page: Any, panel: int) -> list[int]:
    """The colour in the middle of a panel's sphere."""
    return page.evaluate(
        f"(() => {{ const c = trilobe.renderer.canvas, of = document.querySelectorAll('#captions div')[{panel}];"
        " const scale = c.width / c.clientWidth, x = (of.offsetLeft + of.offsetWidth / 2) * scale;"
        " const y = (of.offsetTop - 4 - of.offsetWidth / 2) * scale;"
        " return Array.from(c.getContext('2d').getImageData(x, y, 1, 1).data); })()")


def test_all_but_the_turning_picture_is_there(open_still: Callable[..., Any], pages: dict[str, Path]) -> None:
    page = open_still(pages["plastic"])
    assert "cannot be told apart" in page.inner_text("#verdict")
    wait_for(page, "document.querySelectorAll('#albedo path').length >= 3")
    for chart in ("chart-d", "chart-f", "chart-g", "slice"):
        assert page.locator(f"#{chart} path").count() >= 1, chart
    wait_for(page, "trilobe.page.heat !== null")
    assert page.locator("#views input").count() == 5
    said = page.inner_text("#still-why")
    assert "no WebGL 2" in said and "The program drew what is shown." in said
    for control in ("#object", "#lights input", "#drags input", "#exposure", "#turntable"):
        assert page.locator(control).first.is_disabled(), control
    # The model is edited, and saved.
    page.focus("input[aria-label='Lobe 2: strength']")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("trilobe.state.edit.lobes[1].gain") > 1
    with page.expect_download() as download:
        page.click("#save")
    assert json.loads(Path(download.value.path()).read_text())["format"] == "trilobe-model"
    assert "not told without WebGL 2" in page.inner_text("#verdict")
    assert "without what was changed" in page.inner_text("#captions")


def test_the_spheres_are_those_of_the_program(
        open_still: Callable[..., Any], pages: dict[str, Path], fits: Path) -> None:
    page = open_still(pages["plastic"])
    bytes_ = base64.b64decode(page.evaluate("trilobe.contents.spheres"))
    stored = np.asarray(Image.open(io.BytesIO(bytes_)).convert("RGB")).astype(float)
    assert stored.shape == (96, 192, 3)
    pair = Image.open(fits / "plastic/pair.png").convert("RGB")
    for side, left in enumerate((6, 210)):
        wanted = np.asarray(pair.crop((left, 6, left + 192, 198)).resize((96, 96), Image.Resampling.BOX)).astype(float)
        off = np.abs(stored[:, 96 * side : 96 * side + 96] - wanted)[20:76, 20:76]
        assert off.mean() < 3
    # Both are shown, and where they differ.
    wait_for(page, "trilobe.renderer.image !== null && !trilobe.page.pictureStale")
    for side in (0, 1):
        shown, wanted = pixel(page, side)[:3], stored[48, 48 + 96 * side]
        assert np.abs(np.array(shown) - wanted).max() <= 12
    assert sum(pixel(page, 2)[:3]) > 600
    page.locator("#views input[value=wipe]").check(force=True)
    page.focus("#wipe")
    page.keyboard.press("Home")
    wait_for(page, "!trilobe.page.pictureStale")
    assert np.abs(np.array(pixel(page, 0)[:3]) - stored[48, 144]).max() <= 12


def test_the_point_is_moved_by_keys(open_still: Callable[..., Any], pages: dict[str, Path]) -> None:
    page = open_still(pages["shot_silk"])
    page.focus("#canvas")
    page.keyboard.press("ArrowUp")
    first = page.inner_text("#numbers")
    page.keyboard.press("ArrowRight")
    assert "ρ fitted" in first and page.inner_text("#numbers") != first


def test_what_the_page_has_no_picture_of_is_said(
        open_still: Callable[..., Any], pages: dict[str, Path], fits: Path, tmp_path: Path) -> None:
    page = open_still(pages["plastic"])
    page.set_input_files("#file", fits / "shot_silk/model.json")
    wait_for(page, "document.querySelector('#message').textContent === 'Opened model.json.'")
    assert page.locator("#captions div").count() == 1
    assert "no picture of it is in the page" in page.inner_text("#captions")
    # A page of an older program.
    old = tmp_path / "old.html"
    old.write_text(re.sub(r'"spheres":\s*"[^"]*",?', "", pages["plastic"].read_text()))
    page = open_still(old)
    assert "The page holds none that the program drew" in page.inner_text("#still-why")
    assert "no picture of it is in the page" in page.inner_text("#captions")
    assert "cannot be told apart" in page.inner_text("#verdict")


def test_a_picture_that_is_dropped_stands_still(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=32, light="lamp")
    page.evaluate("trilobe.renderer.gl.getExtension('WEBGL_lose_context').loseContext()")
    wait_for(page, "trilobe.renderer.isStill && trilobe.renderer.image && !trilobe.page.pictureStale")
    assert "the graphics card has dropped it" in page.inner_text("#still-why")
    assert pixel(page, 1)[3] == 255
