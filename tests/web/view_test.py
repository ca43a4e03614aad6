"""`trilobe view`: the page draws what the program draws, and does what its buttons say, in a real browser."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image

from conftest import Open, finished, picture, run, wait_for


def encoded(linear: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    x = np.clip(linear, 0, 1)
    return np.round(255 * np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055))


def halves(fits: Path, name: str) -> list[npt.NDArray[np.float64]]:
    """The measured and the fitted sphere of pair.png, 192 pixels wide each."""
    pair = np.asarray(Image.open(fits / name / "pair.png").convert("RGB")).astype(float)
    assert pair.shape[:2] == (228, 408)
    return [pair[6:198, left + 6 : left + 198] for left in (0, 204)]


def twice(linear: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """A picture of twice the size, linear between the middles of pixels."""
    for axis in (0, 1):
        before, after = np.roll(linear, 1, axis), np.roll(linear, -1, axis)
        pairs = np.stack([0.75 * linear + 0.25 * before, 0.75 * linear + 0.25 * after], axis + 1)
        linear = pairs.reshape(*[2 * n if k == axis else n for k, n in enumerate(linear.shape)])
    return linear


# A table is rendered in 192 pixels for pair.png; at nodes in 96, and enlarged.
@pytest.mark.parametrize(("name", "size"), [("plastic", 192), ("shot_silk", 96)])
def test_the_sphere_is_that_of_the_program(name: str, size: int, open_page: Open, fits: Path) -> None:
    page = open_page(name, size=(1200, 800))
    page.evaluate(f"trilobe.state.size = {size}; trilobe.renderer.rate = trilobe.renderer.patience = 1e9;"
                  f" trilobe.renderer.exposure = 0; trilobe.renderer.setSize({size})")
    finished(page, 240)  # all of it at once, without a graphics card
    y, x = np.mgrid[:192, :192] + 0.5 - 96
    inside = np.hypot(x, y) < 96 * 46.5 / 48 - (3 if size == 96 else 0)
    for side, wanted in zip((1, 0), halves(fits, name), strict=True):
        if side == 1 and name == "shot_silk":
            continue  # between nodes linear on the page, and as fitted in the picture
        shown = picture(page, side)
        off = np.abs(encoded(shown if size == 192 else twice(shown)) - wanted).max(axis=-1)[inside]
        assert (off <= 1).mean() >= 0.99, f"{['fitted', 'measured'][side]}: {(off > 1).sum()} pixels are off"


def test_delta_e_is_that_of_the_report(open_page: Open, fits: Path) -> None:
    report = json.loads((fits / "plastic/report.json").read_text())
    mean = report["appearance"]["mean_delta_e"]
    wanted = f"ΔE {float(f'{mean:.2g}'):g} "
    page = open_page("plastic")
    caption = "document.querySelector('#captions').lastChild.textContent"
    assert wanted in page.inner_text("#verdict") and wanted in page.evaluate(caption)
    assert "as shown" not in page.evaluate(caption)
    # Under another light the caption tells the page's own result apart.
    page.locator("#lights input[value=lamp]").check(force=True)
    finished(page)
    wait_for(page, f"{caption}.includes('as shown')")


def test_the_map_says_what_is_hardly_seen(open_page: Open) -> None:
    page = open_page("plastic")
    wait_for(page, "!document.getElementById('hardly-seen').hidden")
    assert "0.3 % of the light" in page.inner_text("#difference")
    # Grazing light far from the highlight is hatched, the highlight is not.
    surface = "getComputedStyle(document.documentElement).getPropertyValue('--surface')"
    row, width, ratio = page.evaluate(
        "(() => { const map = document.getElementById('heat'), {width, height} = map;"
        " return [Array.from(map.getContext('2d').getImageData(0, height / 2, width, 1).data), width,"
        " width / map.clientWidth]; })()")
    pixels = np.array(row).reshape(width, 4)[:, :3]
    white = (pixels == 255).all(axis=1)
    assert page.evaluate(surface) == "#ffffff"
    assert white[int(width - 24 * ratio) : int(width - 10 * ratio)].any()
    assert not white[int(45 * ratio) : width // 2].any()


def test_a_nearly_diffuse_lobe_is_called_so(open_page: Open, fits: Path) -> None:
    lobes = json.loads((fits / "plastic/report.json").read_text())["light"]["lobes"]
    page = open_page("plastic")
    chips = page.locator("#lobes label")
    for m, lobe in enumerate(lobes):
        assert ("(nearly diffuse)" in chips.nth(m).inner_text()) == lobe["nearly_diffuse"]
    # A flat model made by hand, since the fixture's lobes need not be nearly diffuse.
    flat = page.evaluate(
        "(() => { const model = structuredClone(trilobe.model), {D, G} = model.tables; D[0].fill(0.3);"
        " G[0].forEach((_, k) => (G[0][k] = 2 * Math.cos(((k + 0.5) / G[0].length) * Math.PI / 2)));"
        " return [0, 1].map(m => trilobe.isNearlyDiffuse(model, m)); })()")
    assert flat[0] is True and flat[1] == lobes[1]["nearly_diffuse"]


def test_both_columns_are_full(open_page: Open) -> None:
    page = open_page("plastic", size=(1400, 900))
    ends = page.evaluate("Array.from(document.querySelectorAll('.column'),"
                         " c => c.lastElementChild.getBoundingClientRect().bottom)")
    assert len(ends) == 2 and min(ends) > 0.75 * max(ends)
    # The picture stays while one changes the model.
    page.evaluate("window.scrollTo(0, 500)")
    top = page.evaluate("document.getElementById('picture').getBoundingClientRect().top")
    assert 0 <= top < 100


def test_dragging_moves_the_lamp(open_page: Open) -> None:
    page = open_page("plastic", light="lamp", view="fitted")
    before, image = page.evaluate("trilobe.renderer.lamp"), picture(page, 0)
    box = page.locator("#canvas").bounding_box()
    middle = box["x"] + box["width"] / 2, box["y"] + 200
    page.mouse.move(*middle)
    page.mouse.down()
    page.mouse.move(middle[0] + 60, middle[1] + 30, steps=3)
    page.mouse.up()
    finished(page)
    assert page.evaluate("trilobe.renderer.lamp") != before
    assert np.abs(picture(page, 0) - image).max() > 0.1
    after = page.evaluate("trilobe.renderer.lamp")
    page.focus("#canvas")
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("trilobe.renderer.lamp")[0] < after[0]


def test_the_pointer_reads_both_values(open_page: Open) -> None:
    page = open_page("plastic", view="fitted")
    box = page.locator("#canvas").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 200)
    page.wait_for_timeout(100)
    rows = {row.split("\t")[0]: row.split("\t")[1:] for row in page.inner_text("#numbers").split("\n")}
    measured, fitted = (np.array([float(x) for x in rows[f"ρ {kind}"]]) for kind in ("measured", "fitted"))
    assert np.abs(fitted / measured - 1).max() < 0.1
    assert all(0 < float(x) < 1 for x in rows["albedo at θo"])


def test_the_map_has_no_gaps_where_a_table_is_coarse(open_page: Open) -> None:
    page = open_page("coarse")
    opaque = page.evaluate(
        "(() => { const map = document.getElementById('heat'), {width, height} = map, r = width / map.clientWidth;"
        " const row = map.getContext('2d').getImageData(44 * r, height - 24 * r, 0.7 * width, 1).data;"
        " return Array.from(row).filter((_, k) => k % 4 === 3); })()")
    assert len(opaque) > 100 and min(opaque) == 255


def test_views_are_chosen_by_the_keyboard(open_page: Open) -> None:
    page = open_page("plastic")
    assert page.locator("#captions div").count() == 3
    page.focus("#views input[value=side]")
    page.keyboard.press("ArrowRight")
    assert page.evaluate("trilobe.state.view") == "wipe"
    page.focus("#wipe")
    page.keyboard.press("Home")
    assert page.evaluate("trilobe.state.wipe") == 0


def test_lobes_go_off_and_an_edited_model_is_saved(open_page: Open, tmp_path: Path) -> None:
    page = open_page("plastic", view="fitted")
    whole = picture(page, 0)
    page.locator("#lobes input[aria-label='lobe 1 on']").uncheck()
    finished(page)
    assert picture(page, 0).sum() < 0.95 * whole.sum()
    page.click("#undo")
    finished(page)
    assert np.allclose(picture(page, 0), whole, rtol=1e-5)
    page.focus("input[aria-label='Lobe 2: strength']")
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    page.focus("input[aria-label='Lobe 2: roughness']")
    page.keyboard.press("ArrowRight")
    page.locator("input[aria-label='Lobe 1: tint']").fill("#ff8800")
    finished(page)
    assert "changed since" in page.inner_text("#verdict")
    changed = picture(page, 0)
    with page.expect_download() as download:
        page.click("#save")
    saved = tmp_path / "saved.json"
    download.value.save_as(saved)
    assert "822 parameters" in run("info", saved)
    # The saved model looks as the page showed it.
    page.set_input_files("#file", saved)
    wait_for(page, "document.querySelector('#message').textContent.startsWith('Opened')")
    finished(page)
    again = picture(page, 0) / page.evaluate("trilobe.renderer.exposure")
    assert np.abs(again / max(again.max(), 1e-9) - changed / changed.max()).max() < 1e-4


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "not JSON"),
        ('{"format": "other"}', "key 'format'"),
        ('{"format": "trilobe-model", "version": 1, "kind": "isotropic", "lobes": 99}', "key 'lobes'"),
        ('{"format": "trilobe-model", "version": 1, "kind": "isotropic", "lobes": 1, "d": [1, 1, -1]}', "key 'd'"),
        ('{"format": "trilobe-model", "version": 1, "stretch": {"along": 1, "across": 0}}', "key 'stretch' needs"),
        ("hello", "none of what this page reads: a model of trilobe (.json), a MERL measurement"),
        ("x,y\n1,2\n", "theta_i,phi_i,theta_o,phi_o,r,g,b in degrees (.csv)"),
        ("\0\1", "not a MERL file"),
        ("theta_i,phi_i,theta_o,phi_o,r,g\n", "header"),
        ("theta_i,phi_i,theta_o,phi_o,r,g,b\n1,2,3\n", "row 2"),
        ("theta_i,phi_i,theta_o,phi_o,r,g,b\n1,0,1.5,0,1,1,1\n", "as in radians"),
        ("theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,-50,0,1,1,1\n", "negative angle"),
        ("theta_i,phi_i,theta_o,phi_o,r,g,b\n10,0,95,0,1,1,1\n", "no sample above the surface"),
    ],
)
def test_a_broken_file_gives_one_line(text: str, words: str, open_page: Open, tmp_path: Path) -> None:
    page = open_page("alone")
    (tmp_path / "broken").write_text(text)
    page.set_input_files("#file", tmp_path / "broken")
    wait_for(page, "document.querySelector('#message').textContent !== ''")
    message = page.inner_text("#message")
    assert message.startswith("broken: ") and words in message and "\n" not in message
    finished(page)


def test_a_measurement_is_opened(open_page: Open, tmp_path: Path) -> None:
    run("synth", "plastic", f"--out={tmp_path}/plastic.binary")
    page = open_page("alone")
    page.set_input_files("#file", tmp_path / "plastic.binary")
    wait_for(page, "document.querySelector('#message').textContent.startsWith('Opened')")
    finished(page)
    assert page.locator("#captions div").count() == 3
    assert page.evaluate("trilobe.renderer.measured.shape") == [90, 90, 90]


def test_a_link_holds_the_state(open_page: Open) -> None:
    page = open_page("plastic", view="difference", object="knot", exposure=1.5,
                     edit={"lobes": [{"gain": 2}, {}, {"on": False}]})
    state = page.evaluate("[trilobe.state.view, trilobe.state.object, trilobe.state.exposure]")
    assert state == ["difference", "knot", 1.5]
    assert page.evaluate("trilobe.model.s[2]") == [0, 0, 0]
    page.click("#link")
    wait_for(page, "document.querySelector('#message').textContent !== ''")
    address = page.url
    page.goto("about:blank")
    page.goto(address)
    finished(page)
    assert page.evaluate("trilobe.state.edit.lobes[0].gain") == 2


@pytest.mark.parametrize("thing", ["sphere", "knot", "cloth", "flat"])
def test_objects_are_lit(thing: str, open_page: Open) -> None:
    page = open_page("shot_silk", object=thing, view="side", turn=[0.4, -0.4])
    for side in (0, 1):
        lit = (picture(page, side) > 0).all(axis=-1).mean()
        assert 0.2 < lit <= 1


@pytest.mark.parametrize("size", [(390, 844), (1024, 768), (1680, 1050)])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_pages_fit_their_window(size: tuple[int, int], scheme: str, open_page: Open) -> None:
    page = open_page("plastic", size=size, scheme=scheme)
    assert page.evaluate("document.documentElement.scrollWidth") <= size[0]
    assert page.evaluate("document.documentElement.dataset.theme") == scheme


def test_everything_has_a_name(open_page: Open) -> None:
    page = open_page("plastic")
    nameless = page.evaluate(
        """Array.from(document.querySelectorAll('button, input:not([hidden]), select, canvas')).filter(e =>
          !(e.getAttribute('aria-label') || e.ariaLabel || e.textContent.trim() || e.labels?.[0]?.textContent.trim() ||
            e.getAttribute('aria-describedby'))).map(e => e.outerHTML)""")
    assert nameless == []


def test_pages_are_small(pages: dict[str, Path]) -> None:
    assert pages["alone"].stat().st_size <= 300e3
    assert pages["plastic"].stat().st_size <= 2e6 and pages["shot_silk"].stat().st_size <= 2e6
    for page in pages.values():
        text = page.read_text()
        assert "http://" not in text.replace("http://www.w3.org/2000/svg", "") and "https://" not in text


def test_a_probe_lights_the_page(fits: Path, tmp_path: Path, browser: Any) -> None:
    width, height = 64, 32
    pixels = np.zeros((height, width, 4), np.uint8)
    pixels[..., :] = [64, 64, 64, 128]  # 0.25 everywhere,
    pixels[4:8, 20:24] = [128, 16, 16, 136]  # and a red lamp
    header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"-Y {height} +X {width}\n".encode()
    (tmp_path / "lamp.hdr").write_bytes(header + pixels.tobytes())
    out = tmp_path / "out"
    run("fit", "synth:plastic", "synth:felt", "--solver=awls", "--max_iterations=1", f"--probe={tmp_path}/lamp.hdr",
        f"--out={out}")
    run("view", out / "plastic/model.json", "synth:plastic", f"--probe={tmp_path}/lamp.hdr", f"--out={tmp_path}/x.html")
    page = browser.new_page()
    page.goto(f"file://{tmp_path}/x.html")
    wait_for(page, "window.trilobe?.renderer?.shown")
    page.evaluate("trilobe.state.size = 192; trilobe.renderer.rate = trilobe.renderer.patience = 1e9;"
                  " trilobe.renderer.setSize(192)")
    finished(page)
    y, x = np.mgrid[:192, :192] + 0.5 - 96
    off = np.abs(encoded(picture(page, 1)) - halves(out, "plastic")[0]).max(axis=-1)[np.hypot(x, y) < 93]
    page.close()
    assert (off <= 1).mean() >= 0.98, f"{(off > 1).sum()} pixels are off, by {off.max()}"
