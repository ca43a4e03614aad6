"""Charts of a page: their values, scales, curves and files; the map at one phi_d; the plane of incidence; albedo."""

from __future__ import annotations

import json
import math
import xml.etree.ElementTree as xml
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Open, finished, run, wait_for

DRAWN = "!trilobe.page.chartsStale"


def labels(page: Any, chart: str) -> list[str]:
    return page.evaluate(f"Array.from(document.getElementById('{chart}').closest('figure').querySelectorAll('.key'),"
                         " key => key.textContent)")


def saved(page: Any, button: str) -> str:
    with page.expect_download() as download:
        page.click(f"button[aria-label='{button}']")
    return Path(download.value.path()).read_text()


def choose(page: Any, select: str, value: str) -> None:
    page.select_option(select, value)
    wait_for(page, DRAWN)


def test_values_are_read_by_pointer_and_keys(open_page: Open, fits: Path) -> None:
    page = open_page("plastic", size_of_picture=16)
    wait_for(page, DRAWN)
    page.locator("#chart-g").hover(position={"x": 100, "y": 60})
    values = page.locator("#factors .values:visible")
    head, *curves = values.inner_text().split("\n")
    theta = float(head.removeprefix("θ ").removesuffix("°"))
    tables = json.loads((fits / "plastic/model.json").read_text())["G"]
    for m, line in enumerate(curves):
        name, value = line.rsplit(" ", 1)
        assert name == f"lobe {m + 1}"
        wanted = np.interp(theta, (np.arange(90) + 0.5), tables[m])
        assert float(value) == pytest.approx(wanted, rel=0.02, abs=2e-3)
    page.mouse.move(5, 5)
    assert values.count() == 0
    page.focus("#chart-d")
    page.keyboard.press("ArrowRight")
    first = values.inner_text()
    page.keyboard.press("ArrowRight")
    assert first.startswith("θh") and values.inner_text() != first


def test_a_scale_is_chosen_and_kept(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16)
    wait_for(page, DRAWN)
    path = "document.querySelector('#chart-d path').getAttribute('d')"
    before = page.evaluate(path)
    page.locator("input[aria-label='D over theta h: logarithmic']").uncheck()
    wait_for(page, f"{path} !== {json.dumps(before)}")
    assert page.locator("#chart-d text").first.text_content() == "0"
    page.click("#link")
    wait_for(page, "location.hash.length > 1 && document.querySelector('#message').textContent !== ''")
    address = page.url
    page.goto("about:blank")
    page.goto(address)
    finished(page)
    wait_for(page, DRAWN)
    assert not page.locator("input[aria-label='D over theta h: logarithmic']").is_checked()


def test_a_part_is_seen_larger(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16)
    wait_for(page, DRAWN)
    texts = "Array.from(document.querySelectorAll('#chart-g text'), t => t.textContent)"
    whole = page.evaluate(texts)
    page.locator("#chart-g").scroll_into_view_if_needed()
    box = page.locator("#chart-g").bounding_box()
    page.mouse.move(box["x"] + 80, box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 140, box["y"] + 50, steps=3)
    page.mouse.up()
    assert page.evaluate(texts) != whole
    page.click("button[aria-label='G over theta: the whole range']")
    assert page.evaluate(texts) == whole


@pytest.fixture(scope="session")
def twelve(fits: Path, pages: dict[str, Path]) -> None:
    """Four lobes, D of each for each channel, as --model=auto may make it; its page is pages["twelve"]."""
    model = json.loads((fits / "plastic/model.json").read_text())
    tables = [*model["D"], model["D"][1]]
    model |= {"lobes": 4, "s": [*model["s"], model["s"][0]], "G": [*model["G"], model["G"][0]],
              "D": [[[v * (1 + 0.2 * c) for v in table] for c in range(3)] for table in tables],
              "sharing": {factor: {"per_lobe": factor != "F", "per_channel": factor != "G"} for factor in "DFG"}}
    model.pop("unobserved", None)
    path = fits / "twelve.json"
    path.write_text(json.dumps(model))
    pages["twelve"] = fits / "twelve.html"
    run("view", path, f"--out={pages['twelve']}")


@pytest.mark.usefixtures("twelve")
def test_curves_are_chosen_by_lobe_and_channel(open_page: Open) -> None:
    page = open_page("twelve", size_of_picture=16)
    wait_for(page, DRAWN)
    colors = ("Array.from(document.querySelectorAll('#chart-d path[stroke-width=\"2\"]'),"
              " path => path.getAttribute('stroke'))")
    # At first there is one line per lobe in its colour, instead of twelve lines.
    assert labels(page, "chart-d") == [f"lobe {m}" for m in (1, 2, 3, 4)]
    lobes = page.evaluate(colors)
    assert lobes[:3] == ["#E69F00", "#56B4E9", "#CC79A7"]
    choose(page, "#chart-lobe", "1")
    choose(page, "#chart-channel", "each")
    assert labels(page, "chart-d") == ["lobe 2, red", "lobe 2, green", "lobe 2, blue"]
    channels = page.evaluate(colors)
    assert len(set(channels)) == 3 and not set(channels) & set(lobes)
    choose(page, "#chart-channel", "2")
    assert labels(page, "chart-d") == ["lobe 2, blue"]
    choose(page, "#chart-lobe", "")
    choose(page, "#chart-channel", "each")
    assert len(labels(page, "chart-d")) == 12


def test_charts_are_saved(open_page: Open, fits: Path) -> None:
    page = open_page("plastic", size_of_picture=16)
    wait_for(page, DRAWN)
    header, *lines = saved(page, "F over theta d as CSV").splitlines()
    assert header == "curve,theta_d_deg,F,no_data"
    table = json.loads((fits / "plastic/model.json").read_text())["F"]
    greens = [line.split(",") for line in lines if line.startswith('"green"')]
    assert [float(cell[2]) for cell in greens] == pytest.approx(table[1], rel=1e-5)
    assert [float(cell[1]) for cell in greens] == pytest.approx([k + 0.5 for k in range(90)], rel=1e-5)
    root = xml.fromstring(saved(page, "D over theta h as SVG"))
    assert root.tag == "{http://www.w3.org/2000/svg}svg" and float(root.get("height")) > 170
    assert "lobe 3" in "".join(root.itertext())
    assert "var(" not in xml.tostring(root, encoding="unicode")
    rows = saved(page, "Map as CSV").splitlines()
    assert rows[0] == "theta_h_deg,theta_d_deg,fitted_over_measured" and len(rows) > 1000


def test_the_map_is_of_one_phi_d(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16)
    wait_for(page, f"{DRAWN} && trilobe.page.heat !== null")
    page.check("#one-phi-d")
    wait_for(page, "document.getElementById('map-of').textContent.includes('φd 90°')")
    ratio = "Array.from(trilobe.page.heatAt.ratio)"
    at_90 = page.evaluate(ratio)
    assert at_90 != page.evaluate("Array.from(trilobe.page.heat.ratio)")
    # Each bin is the mean of the two times two of the table in it.
    wanted = page.evaluate(
        """(() => { const {measured, evaluate} = trilobe.page, [nh, nd, np] = measured.shape;
          const light = c => 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2], right = Math.PI / 2;
          const logs = [20, 21].flatMap(h => [40, 41].map(d => {
            const k = (h * nd + d) * np + np / 2, phi = ((np / 2 + 0.5) / np) * Math.PI;
            const [wi, wo] = trilobe.directionsOf(((h + 0.5) / nh) ** 2 * right, ((d + 0.5) / nd) * right, phi);
            return Math.log(light(evaluate(wi, wo).rho) / light(measured.rgb.slice(3 * k, 3 * k + 3))); }));
          return logs.reduce((a, b) => a + b) / 4; })()""")
    assert at_90[10 * 45 + 20] == pytest.approx(wanted, abs=1e-5)
    page.fill("#phi-d-slider", "0")
    wait_for(page, "document.getElementById('phi-d').textContent === '0°'")
    assert page.evaluate(ratio) != at_90
    page.uncheck("#one-phi-d")
    wait_for(page, "document.getElementById('phi-d').textContent === 'all'")


def test_albedo_is_that_of_the_model(open_page: Open, fits: Path) -> None:
    page = open_page("alone", size_of_picture=16)
    model = json.loads((fits / "plastic/model.json").read_text())
    # A diffuse material has pi d at all angles.
    flat = fits / "flat.json"
    flat.write_text(json.dumps({k: model[k] for k in ("format", "version", "kind")}
                               | {"lobes": 0, "d": [0.1, 0.2, 0.3], "s": [], "D": [], "F": [], "G": []}))
    page.set_input_files("#file", flat)
    wait_for(page, "trilobe.page.albedo?.length === 19", 120)
    rows = page.evaluate("trilobe.page.albedo")
    for row in rows[:-1]:
        assert row["fitted"] == pytest.approx([math.pi * d for d in (0.1, 0.2, 0.3)], rel=0.01)
    assert all(row["measured"] is None for row in rows)
    assert page.locator("#albedo path").count() >= 3


def test_measured_albedo_is_beside_the_fitted(open_page: Open) -> None:
    page = open_page("coarse", size_of_picture=16, view="fitted")
    wait_for(page, "trilobe.page.albedo?.length === 19", 120)
    rows = [row for row in page.evaluate("trilobe.page.albedo") if row["measured"]]
    assert len(rows) > 5
    for row in rows:
        assert row["measured"] == pytest.approx(row["fitted"], rel=0.15)
    wait_for(page, "document.getElementById('albedo').ariaLabel.includes(' measured angles')")
    assert "measured" in labels(page, "albedo")


def test_the_slice_has_the_values_of_the_plane(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16)
    page.fill("#polar-theta", "30")
    wait_for(page, f"{DRAWN} && document.getElementById('plane-angle').textContent === '30°'")
    rows = [line.split(",") for line in saved(page, "ρ in the plane of incidence as CSV").splitlines()[1:]]
    fitted = {float(r[-3]): float(r[-2]) for r in rows if r[0] == '"green"'}
    measured = {float(r[-3]): float(r[-2]) for r in rows if '"measured' in r[0] and 'green"' in r[1]}
    peak = max(fitted, key=lambda degrees: fitted[degrees] * (abs(degrees) < 80))
    assert abs(peak - 30) < 3
    near = [(fitted[x], measured[x]) for x in measured if abs(x) < 60]
    assert len(near) > 30 and np.median([abs(a / b - 1) for a, b in near]) < 0.1
    assert page.evaluate("document.querySelectorAll('#slice path[stroke-linecap=round]').length") == 3


def test_words_are_explained(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16)
    for word in ("delta", "angles", "rho", "albedo", "pdf", "rise"):
        assert page.locator(f"summary[aria-label='What is this: {word}']").count() >= 1, word
    page.focus("#canvas")
    page.keyboard.press("Shift+ArrowUp")
    page.locator("#numbers summary[aria-label='What is this: pdf']").click()
    shown = page.locator("#numbers .help[open] .word")
    assert "1/sr" in shown.inner_text()
    box = shown.bounding_box()
    assert box["x"] >= 0 and box["x"] + box["width"] <= 1200
    # It stays while the pointer is read.
    page.focus("#canvas")
    page.keyboard.press("Shift+ArrowUp")
    assert shown.is_visible()
    page.keyboard.press("Escape")
    assert shown.count() == 0
