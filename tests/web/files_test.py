"""Files that are dropped on a page, and pages of scattered samples: no figure, colour or name is of another file."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from conftest import Open, finished, picture, run, wait_for


def samples(to: int, step: int = 10) -> str:
    """A CSV file of a diffuse material with a broad highlight, up to this angle."""
    rows = ["theta_i,phi_i,theta_o,phi_o,r,g,b"]
    for i in range(5, to + 1, step):
        for o in range(0, to + 1, step // 2):
            for phi in range(0, 181, 30):
                value = 0.1 + 0.2 * math.exp(-((i - o) ** 2 + (180 - phi) ** 2) / 800)
                rows.append(f"{i},0,{o},{phi},{value:.5f},{0.8 * value:.5f},{0.6 * value:.5f}")
    return "\n".join(rows)


@pytest.fixture(scope="session")
def scattered(fits: Path, pages: dict[str, Path]) -> Path:
    """The file of samples; its fit's page is pages["scattered"]."""
    path = fits / "broad.csv"
    path.write_text(samples(65))
    run("fit", path, "--lobes=1", "--max_iterations=3", f"--out={fits / 'broad'}")
    pages["scattered"] = fits / "broad/view.html"
    return path


def drop(page: Any, path: Path) -> None:
    page.set_input_files("#file", path)
    wait_for(page, f"document.querySelector('#message').textContent === 'Opened {path.name}.'")


def rows(page: Any, table: str) -> dict[str, list[str]]:
    return {row.split("\t")[0]: row.split("\t")[1:] for row in page.inner_text(table).split("\n")}


def exposed(page: Any) -> float:
    light = picture(page, 0)
    return float(light[light.sum(axis=-1) > 0].clip(0, 1).mean())


def test_five_files_of_five_kinds(open_page: Open, scattered: Path, fits: Path, tmp_path: Path) -> None:
    page = open_page("plastic", size_of_picture=32)
    # Samples have no sphere, and the model keeps its exposure.
    drop(page, scattered)
    finished(page)
    assert page.inner_text("#name") == "plastic beside broad.csv"
    shown = page.evaluate("[trilobe.page.measured.kind, trilobe.renderer.measured, trilobe.state.view]")
    assert shown == ["samples", None, "fitted"]
    assert page.locator("#views").is_hidden() and page.locator("#captions div").count() == 1
    assert 0.1 < exposed(page) < 0.6
    page.locator("#fit summary").click()
    facts = rows(page, "#facts")
    assert facts["fitted to"] == ["synth:plastic"] and facts["shown beside"][0].startswith("broad.csv, ")
    assert "PSNR" not in facts
    assert facts["lobe 1 as GGX"][0].startswith("alpha ")
    # Another model beside the same samples.
    drop(page, fits / "shot_silk/model.json")
    finished(page)
    assert page.inner_text("#name") == "model.json beside broad.csv"
    assert 0.1 < exposed(page) < 0.6
    facts = rows(page, "#facts")
    assert facts["model"] == ["model.json"] and facts["fitted to"] == ["synth:shot_silk"]
    assert "lobe 1 as GGX" not in facts  # which is the program's, of the fit
    with page.expect_download() as download:
        page.click("#save")
    assert download.value.suggested_filename == "model.json"
    # A file of another kind changes nothing.
    (tmp_path / "broken.csv").write_text("theta_i,r\n")
    page.set_input_files("#file", tmp_path / "broken.csv")
    wait_for(page, "document.querySelector('#message').textContent.startsWith('broken.csv: ')")
    assert page.inner_text("#name") == "model.json beside broad.csv"
    # A table: its sphere is back.
    run("synth", "felt", f"--out={tmp_path}/felt.binary")
    drop(page, tmp_path / "felt.binary")
    finished(page)
    assert page.inner_text("#name") == "model.json beside felt.binary"
    assert page.locator("#captions div").count() == 3 and page.evaluate("trilobe.state.view") == "side"
    caption = page.inner_text("#captions div:last-child")
    mean = caption.split("ΔE ")[1].split()[0]
    assert f"ΔE {mean} apart in the mean" in page.inner_text("#verdict")


def test_what_is_read_is_of_the_file_that_is_shown(open_page: Open, scattered: Path) -> None:
    page = open_page("plastic", size_of_picture=32, view="fitted")
    box = page.locator("#canvas").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 200)
    wait_for(page, "document.getElementById('typical').textContent !== ''")
    before = page.inner_text("#typical"), rows(page, "#numbers")
    drop(page, scattered)
    # The pointer has not moved.
    wait_for(page, "document.getElementById('map-of').textContent.startsWith('each sample')")
    after = page.inner_text("#typical"), rows(page, "#numbers")
    assert after[0] != before[0]
    measured = next(values for title, values in after[1].items() if title.startswith("ρ measured"))
    assert measured != before[1]["ρ measured"]
    assert any(title.endswith("away") for title in after[1]) or "no sample within" in measured[0]


def test_the_link_says_what_it_does_not_hold(open_page: Open, scattered: Path) -> None:
    page = open_page("plastic", size_of_picture=32)
    page.click("#link")
    wait_for(page, "document.querySelector('#message').textContent.includes('as it looks now')")
    drop(page, scattered)
    page.click("#link")
    wait_for(page, "document.querySelector('#message').textContent.includes('but not broad.csv')")
    address = page.url
    page.goto("about:blank")
    page.goto(address)
    finished(page)
    message = page.inner_text("#message")
    assert "was made with broad.csv" in message
    assert page.inner_text("#name") == "plastic"


def test_the_verdict_is_of_what_is_shown(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=32)
    verdict = "document.querySelector('#verdict b')"
    assert page.evaluate(f"{verdict}.className") == "none"
    page.locator("button[aria-label='Only the diffuse term']").click()
    finished(page)
    wait_for(page, f"{verdict}?.className === 'plain'")
    mean = page.inner_text("#captions div:last-child").split("ΔE ")[1].split()[0]
    assert float(mean) > 5 and f"ΔE {mean} apart" in page.inner_text("#verdict")
    # A model that is all too dark is at most 100 % too dark.
    wait_for(page, "document.getElementById('typical').textContent.includes('too dark')")
    percents = [float(word) for word in page.inner_text("#typical").split() if word.replace(".", "").isdigit()]
    assert percents and max(percents) <= 100
    page.click("#undo")
    finished(page)
    assert page.evaluate(f"{verdict}.className") == "none"


def test_words_and_colours_are_by_one_rule(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=32)
    rule = page.evaluate("[[0.5, 2], [1.09, 2], [0.5, 3], [3, 4], [6, 7], [1, 11]]"
                         ".map(([mean, at95]) => trilobe.visibilityOf({mean, at95}).name)")
    assert rule == ["none", "hardly", "hardly", "visible", "plain", "plain"]
    colours = page.evaluate("['--good', '--fair', '--warn', '--bad'].map(c =>"
                            " getComputedStyle(document.documentElement).getPropertyValue(c))")
    assert len(set(colours)) == 4


def test_a_page_holds_scattered_samples(open_page: Open, scattered: Path, pages: dict[str, Path]) -> None:
    page = open_page("scattered", size_of_picture=32)
    count = len(scattered.read_text().split("\n")) - 1
    assert page.evaluate("[trilobe.page.measured.kind, trilobe.page.measured.count]") == ["samples", count]
    assert pages["scattered"].stat().st_size <= 300e3
    # The values are those of the file.
    first = page.evaluate("(s => [s.theta_i * 180 / Math.PI, ...s.rho])(trilobe.page.measured.samples[1])")
    wanted = [float(cell) for cell in scattered.read_text().split("\n")[2].split(",")]
    assert first == pytest.approx([wanted[0], *wanted[4:]], rel=1e-5)
    wait_for(page, "trilobe.page.heat !== null")
    assert page.evaluate("trilobe.page.heat.points.length") == count
    assert not page.get_attribute("#polar", "aria-label").endswith(" 0 measured values")
    # The page has the program's note on directions between the samples.
    assert "times the largest measured value" in page.inner_text("#notes") or page.evaluate(
        "trilobe.contents.reach < 2 && trilobe.contents.notes.length === 0")
    assert page.evaluate("trilobe.renderer.leastCosine") == pytest.approx(math.cos(math.radians(65)), abs=1e-6)


def test_what_was_not_measured_is_hatched(open_page: Open, scattered: Path) -> None:
    page = open_page("scattered", size_of_picture=64, exposure=-4)
    # Light lines over a dark picture at the rim, where the eye is beyond 65 degrees, and not inside.
    box, caption = page.locator("#canvas").bounding_box(), page.locator("#captions div").bounding_box()
    radius = caption["width"] / 2
    x, y = box["width"] / 2, caption["y"] - box["y"] - 4 - radius
    shown = np.asarray(Image.open(io.BytesIO(page.locator("#canvas").screenshot())).convert("L")).astype(int)
    columns = [int(x - part * radius) for part in (0.97, 0.7)]
    rim, inside = (shown[int(y) - 10 : int(y) + 10, left : left + 10] for left in columns)
    assert np.ptp(rim) > 60 > np.ptp(inside)


def test_a_dropped_model_is_not_called_the_fit(open_page: Open, fits: Path) -> None:
    page = open_page("plastic", size_of_picture=32)
    assert "the fit:" in page.inner_text("#verdict") and page.inner_text("#fit-title") == "The fit"
    drop(page, fits / "shot_silk/model.json")
    finished(page)
    wait_for(page, "document.querySelector('#verdict b') !== null && !trilobe.page.chartsStale")
    wait_for(page, "document.getElementById('typical').textContent.includes('model.json is')")
    page.focus("#canvas")
    page.keyboard.press("Shift+ArrowUp")
    assert "model.json:" in page.inner_text("#verdict")
    assert page.inner_text("#fit-title") == "The model"
    assert "ρ modelled" in page.inner_text("#numbers")
    words = page.inner_text("main") + page.inner_text("header")
    for word in ("The fit", "the fit ", "the fit:", "Fitted", "ρ fitted"):
        assert word not in words, word


def test_spectral_fits_show_their_wavelengths(fits: Path, browser: Any) -> None:
    bands = range(400, 701, 50)
    lines = ["theta_i,phi_i,theta_o,phi_o," + ",".join(f"{band}nm" for band in bands)]
    for i in range(0, 76, 15):
        for o in range(0, 76, 5):
            for phi in range(0, 181, 20):
                peak = 0.3 * math.exp(-((i - o) ** 2 + (180 - phi) ** 2 / 4) / 200)
                lines.append(f"{i},0,{o},{phi}," + ",".join(f"{0.05 + (b - 400) / 1500 + peak:.5f}" for b in bands))
    (fits / "red.csv").write_text("\n".join(lines))
    run("fit", fits / "red.csv", "--spectral", "--lobes=1", "--max_iterations=3", f"--out={fits / 'red'}")
    run("view", fits / "red/spectral.json", fits / "red.csv", f"--out={fits / 'red/spectral.html'}")
    for name in ("view", "spectral"):
        page = browser.new_page()
        page.goto(f"file://{fits / f'red/{name}.html'}")
        wait_for(page, "window.trilobe?.page.base !== null && !trilobe.page.chartsStale")
        page.locator("#fit summary").click()
        assert rows(page, "#facts")["spectra"] == ["7 wavelengths from 400 to 700 nm; shown are their colours"], name
        page.set_input_files("#file", fits / "red/spectral.json")
        wait_for(page, "document.querySelector('#message').textContent.includes('a model of 7 wavelengths')")
        page.close()
