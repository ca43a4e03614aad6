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


def reopen_by_link(page: Any) -> None:
    """Copies the link, and opens it anew."""
    page.click("#link")
    wait_for(page, "location.hash.length > 1 && document.querySelector('#message').textContent !== ''")
    address = page.url
    page.goto("about:blank")
    page.goto(address)
    finished(page)


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
    reopen_by_link(page)
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


def test_a_log_axis_has_two_labels(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16, log=dict.fromkeys(("D", "F", "G", "slice", "albedo"), True))
    wait_for(page, f"{DRAWN} && trilobe.page.albedo?.length === 19")
    numbers = ("Array.from(document.querySelectorAll('#{} text[text-anchor=end]'))"
               ".filter(t => t.getAttribute('x') === '39').map(t => t.textContent)")
    for chart in ("chart-d", "chart-f", "chart-g", "slice", "albedo"):
        assert page.locator(f"#{chart}").locator("xpath=ancestor::figure").locator("input").is_checked()
        page.focus(f"#{chart}")
        for zoom in range(6):
            found = page.evaluate(numbers.format(chart))
            assert len(found) >= 2 and len(set(found)) == len(found), f"{chart}, {zoom}: {found}"
            page.keyboard.press("+")


def test_the_polar_chart_says_its_radius(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16)
    caption = page.locator("#polar").locator("xpath=ancestor::figure").locator("figcaption").inner_text()
    assert "the radius is the cube root of the mean ρ cos θo" in caption


@pytest.mark.usefixtures("twelve")
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)])
def test_values_cover_no_curve(size: tuple[int, int], open_page: Open) -> None:
    for name, many in (("plastic", False), ("twelve", True)):
        page = open_page(name, size=size, size_of_picture=16)
        if many:
            choose(page, "#chart-channel", "each")
        wait_for(page, DRAWN)
        for chart in ("chart-d", "chart-f", "chart-g", "slice"):
            page.locator(f"#{chart}").hover(position={"x": 120, "y": 80})
            box = page.locator(".values:visible").bounding_box()
            charts = page.evaluate("Array.from(document.querySelectorAll('figure svg, figure canvas'), e =>"
                                   " e.getBoundingClientRect().toJSON()).filter(r => r.width > 0)")
            for other in charts:
                beside = (box["x"] >= other["right"] or box["x"] + box["width"] <= other["x"]
                          or box["y"] >= other["bottom"] - 1 or box["y"] + box["height"] <= other["y"] + 1)
                assert beside, f"{name}: values of {chart}"


def values_of_slice(page: Any, label: str) -> dict[float, float]:
    lines = saved(page, "ρ in the plane of incidence as CSV").splitlines()[1:]
    rows = [line.rsplit(",", 3)[1:] for line in lines if line.startswith(f'"{label}"')]
    return {float(x): float(y) for x, y, _ in rows}


def test_the_plane_is_turned(open_page: Open, fits: Path, tmp_path: Path) -> None:
    page = open_page("plastic", size_of_picture=16)
    page.fill("#polar-theta", "40")
    page.fill("#plane-phi", "30")
    wait_for(page, f"{DRAWN} && document.getElementById('plane-phi-angle').textContent === '30°'")
    assert "the plane at 30° from that of incidence" in page.inner_text("#light")
    assert "mirror" not in page.locator("#slice").text_content()
    fitted, measured = values_of_slice(page, "green"), values_of_slice(page, "measured, green")
    # The program's own values there.
    at = [degrees for degrees in fitted if 5 < abs(degrees) < 70][::7]
    rows = [f"40,180,{abs(x)},{30 if x > 0 else 210}" for x in at]
    (tmp_path / "at.csv").write_text("\n".join(["theta_i,phi_i,theta_o,phi_o", *rows]))
    run("convert", fits / "plastic/model.json", f"--at={tmp_path}/at.csv", f"--out={tmp_path}/values.csv")
    header, *lines = [line for line in (tmp_path / "values.csv").read_text().splitlines() if not line.startswith("#")]
    green = header.split(",").index("g")
    assert [fitted[x] for x in at] == pytest.approx([float(line.split(",")[green]) for line in lines], rel=2e-3)
    near = [fitted[x] / measured[x] for x in measured if abs(x) < 60]
    assert len(near) > 30 and abs(np.median(near) - 1) < 0.1
    # The light's azimuth counts for anisotropic models alone.
    assert page.locator("#light-phi-row").is_hidden()
    page = open_page("shot_silk", size_of_picture=16)
    wait_for(page, DRAWN)
    before = values_of_slice(page, "green")
    page.fill("#light-phi", "90")
    wait_for(page, f"{DRAWN} && document.getElementById('light-phi-angle').textContent === '90°'")
    assert values_of_slice(page, "green") != before


def test_many_models_are_in_the_charts(open_page: Open, fits: Path, tmp_path: Path) -> None:
    page = open_page("plastic", size_of_picture=16)
    for name in ("second", "third", "fourth"):
        model = json.loads((fits / "plastic/model.json").read_text())
        model["D"] = [[2 * v for v in table] for table in model["D"]] if name == "fourth" else model["D"]
        (tmp_path / f"{name}.json").write_text(json.dumps(model))
    page.set_input_files("#file", [tmp_path / f"{name}.json" for name in ("second", "third", "fourth")])
    wait_for(page, "document.querySelector('#message').textContent === 'Opened fourth.json.'")
    page.locator("input[aria-label='Lobe 1: strength']").fill("2")
    page.click("#keep")
    wait_for(page, f"{DRAWN} && trilobe.page.kept.length === 2 && trilobe.page.kept.every(k => k.albedo.length === 19)")
    names = ["fourth.json", "second.json, edited"]
    for chart in ("chart-d", "chart-f", "chart-g", "slice", "albedo"):
        assert labels(page, chart)[-2:] == names, chart
    lines = [line.split(",") for line in saved(page, "D over theta h as CSV").splitlines()]
    own = [float(line[2]) for line in lines if line[0] == '"lobe 1"']
    kept = [float(line[2]) for line in lines if line[0] == '"fourth.json: lobe 1"']
    assert kept == pytest.approx([2 * v for v in own], rel=1e-5)
    page.click("button[aria-label='Remove fourth.json from the charts']")
    wait_for(page, DRAWN)
    assert labels(page, "slice")[-1] == names[1] and "fourth.json" not in labels(page, "slice")
    page.click("#link")
    wait_for(page, "document.querySelector('#message').textContent.includes('edited')")


def test_a_table_is_changed_by_hand(open_page: Open, fits: Path) -> None:
    page = open_page("plastic", size_of_picture=16)
    table = json.loads((fits / "plastic/model.json").read_text())["G"][1]
    page.select_option("#hand-table", label="G of lobe 2")
    page.fill("#hand-theta", "30.5")
    assert float(page.input_value("#hand-value")) == pytest.approx(table[30], rel=1e-3)
    page.fill("#hand-width", "4")
    page.fill("#hand-value", "2")
    page.keyboard.press("Enter")
    wait_for(page, DRAWN)
    changed = page.evaluate("Array.from(trilobe.model.tables.G[1])")
    assert changed[30] == pytest.approx(2, abs=1e-6)
    assert changed[32] == pytest.approx(table[32] + 0.5 * (2 - table[30]), rel=1e-5)
    assert changed[:27] == pytest.approx(table[:27]) and changed[34:] == pytest.approx(table[34:])
    with page.expect_download() as download:
        page.click("#save")
    assert json.loads(Path(download.value.path()).read_text())["G"][1][30] == pytest.approx(2, abs=1e-6)
    reopen_by_link(page)
    assert page.evaluate("trilobe.model.tables.G[1][30]") == pytest.approx(2, abs=1e-6)
    page.click("#reset")
    assert page.evaluate("Array.from(trilobe.model.tables.G[1])") == pytest.approx(table)


def test_the_lobe_is_seen_in_space(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16)
    wait_for(page, DRAWN)
    assert "at most" in page.evaluate("document.getElementById('lobe').ariaLabel")
    drawn = "document.getElementById('lobe').toDataURL()"
    first = page.evaluate(drawn)
    page.focus("#lobe")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("trilobe.state.lobeTurn") == 40 and page.evaluate(drawn) != first
    page.keyboard.press("ArrowLeft")
    assert page.evaluate(drawn) == first
    page.fill("#polar-theta", "70")
    wait_for(page, f"{drawn} !== {json.dumps(first)}")
