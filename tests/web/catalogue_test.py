"""The page of many fits: sorted, filtered, compared, and quick with two hundred of them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from conftest import run, wait_for


@pytest.fixture
def folder(fits: Path, tmp_path: Path) -> Path:
    """Two hundred fits: copies of two, with other figures."""
    for k in range(200):
        name = ("plastic", "shot_silk")[k % 2]
        place = tmp_path / f"{name}_{k:03}"
        place.mkdir()
        for file in ("model.json", "pair.png"):
            shutil.copy(fits / name / file, place / file)
        report = json.loads((fits / name / "report.json").read_text())
        report["appearance"]["psnr_db"] = 20 + (37 * k) % 200 / 10
        (place / "report.json").write_text(json.dumps(report))
    return tmp_path


def test_two_hundred_fits_are_sorted_filtered_and_compared(folder: Path, browser: Any) -> None:
    assert "200 fits" in run("view", folder)
    page = browser.new_page()
    complaints: list[str] = []
    page.on("console", lambda m: complaints.append(m.text))
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(f"file://{folder}/index.html")
    names = "Array.from(document.querySelectorAll('main figure:not([hidden]) figcaption b'), b => b.textContent)"
    assert page.evaluate(names)[0] == "plastic_000"
    page.select_option("select", label="PSNR, best first")
    best = max(range(200), key=lambda k: (37 * k) % 200)
    assert page.evaluate(names)[0].endswith(f"_{best:03}")
    page.select_option("select", label="anisotropic first")
    assert page.evaluate(names)[0].startswith("shot_silk")
    page.fill("input[type=search]", "silk 11")
    assert page.evaluate(names) == [f"shot_silk_{k:03}" for k in (11, *range(111, 120, 2))]
    page.fill("input[type=search]", "")
    milliseconds = page.evaluate("(() => { const t = performance.now(); catalogue.order.value = 6; catalogue.arrange();"
                                 " document.body.offsetHeight; return performance.now() - t; })()")
    assert milliseconds < 1000
    # Verdicts have the colours that they have on the page of a fit.
    for kind, color in (("none", "--good"), ("hardly", "--fair"), ("visible", "--warn"), ("plain", "--bad")):
        shown, wanted = page.evaluate(
            "([kind, color]) => { const mark = document.querySelector('main figcaption span'), own = mark.className;"
            " mark.className = kind; const shown = getComputedStyle(mark).color; mark.className = own;"
            " const probe = document.createElement('i'); probe.style.color = `var(${color})`;"
            " document.body.append(probe);"
            " const wanted = getComputedStyle(probe).color; probe.remove(); return [shown, wanted]; }", [kind, color])
        assert shown == wanted
    classes = page.evaluate("Array.from(document.querySelectorAll('main figcaption span'), s => s.className)")
    assert len(classes) == 200 and set(classes) <= {"none", "hardly", "visible", "plain", "unknown"}
    # The button to compare covers no sphere.
    box, image = (page.locator(f"main figure {what}").first.bounding_box() for what in ("label", "img"))
    assert box["y"] >= image["y"] + image["height"]
    for k in range(4):
        page.locator("main figure input").nth(k).check()
    assert page.locator("#compared figure").count() == 4
    assert page.locator("main figure input").nth(5).is_disabled()
    # Cards of a row are of one height.
    heights = page.evaluate("Array.from(document.querySelectorAll('main figure:not([hidden])'), f => f.offsetHeight)")
    assert len(set(heights[:3])) == 1
    page.close()
    assert [text for text in complaints if "GPU stall due to ReadPixels" not in text] == []


def test_models_are_compared_under_one_light(folder: Path, browser: Any) -> None:
    for fit in folder.iterdir():
        if fit.name not in ("plastic_000", "plastic_002", "plastic_004"):
            shutil.rmtree(fit)
    other = json.loads((folder / "plastic_004/model.json").read_text())
    (folder / "plastic_004/model.json").write_text(json.dumps(other | {"d": [0.2, 0.02, 0.01]}))
    run("view", folder)
    page = browser.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(f"file://{folder}/index.html")
    page.select_option("select", label="name")
    for k in (0, 1, 2):
        page.locator("main figure input").nth(k).check()
    drawn = "[...document.querySelectorAll('#compared .common')].filter(p => p.textContent !== '').length"
    wait_for(page, f"{drawn} === 3", 180)
    said = page.evaluate("Array.from(document.querySelectorAll('#compared .common'), p => p.textContent)")
    assert said[0].endswith("the first")
    # Two of the same model, and another.
    assert said[1].startswith("ΔE 0 from plastic_000: cannot be told apart")
    assert float(said[2].split()[1]) > 3 and "plainly visible" in said[2]
    spheres = page.evaluate(
        "Array.from(document.querySelectorAll('#compared canvas'), c =>"
        " Array.from(c.getContext('2d').getImageData(96, 60, 1, 1).data))")
    assert spheres[0] == spheres[1] != spheres[2]
    page.locator("main figure input").nth(1).uncheck()
    page.locator("main figure input").nth(2).uncheck()
    assert page.locator("#compared canvas").count() == 0
    page.close()
    assert complaints == []
