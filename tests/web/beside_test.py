"""Files dropped beside a model: a second model, and light."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from conftest import Open, finished, picture, run, wait_for


def test_two_models_are_beside_each_other(open_page: Open, fits: Path, tmp_path: Path) -> None:
    page = open_page("plastic", size_of_picture=32)
    own = picture(page, 0)
    other = tmp_path / "other.json"
    other.write_text((fits / "shot_silk/model.json").read_text())
    page.set_input_files("#file", [fits / "plastic/model.json", other])
    wait_for(page, "document.querySelector('#message').textContent === 'Opened other.json.'")
    finished(page)
    assert page.inner_text("#name") == "model.json beside other.json"
    captions = page.locator("#captions b")
    assert [captions.nth(k).inner_text() for k in (0, 1)] == ["other.json", "model.json"]
    assert page.evaluate("trilobe.page.measured.kind") == "model"
    # Both are what they are alone.
    fitted, beside = picture(page, 0), picture(page, 1)
    assert np.abs(fitted / fitted.max() - own / own.max()).max() < 1e-4
    page.set_input_files("#file", other)
    wait_for(page, "document.getElementById('name').textContent === 'other.json beside other.json'")
    finished(page)
    alone = picture(page, 0)
    assert np.abs(alone / alone.max() - beside / beside.max()).max() < 1e-4
    # A model is like itself.
    wait_for(page, "trilobe.page.seen?.mean < 1e-3")
    assert "cannot be told apart" in page.inner_text("#verdict")
    wait_for(page, "trilobe.page.heat !== null")
    assert page.evaluate("trilobe.page.heat.typical") < 1e-6
    assert page.inner_text("#difference .hint").startswith("other.json over other.json")
    assert "measured" not in page.inner_text("#numbers") and "measured" not in page.inner_text("#verdict")


def radiance(width: int, packed: bool) -> bytes:
    """A probe with a red lamp, in runs or not."""
    pixels = np.full((width // 2, width, 4), (64, 64, 64, 128), np.uint8)
    pixels[4:8, 20:24] = [128, 16, 16, 136]
    body = pixels.tobytes()
    if packed:
        body = b""
        for row in pixels:
            body += bytes([2, 2, width >> 8, width & 255])
            for c in range(4):
                values = row[:, c]
                ends = [*(np.flatnonzero(np.diff(values.astype(int))) + 1), width]
                begin = 0
                for end in ends:
                    for at in range(begin, end, 100):
                        count = min(100, end - at)
                        one = bytes([128 + count, values[begin]])
                        body += one if count > 2 else bytes([count, *values[at : at + count]])
                    begin = end
    return b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + f"-Y {width // 2} +X {width}\n".encode() + body


@pytest.mark.parametrize("packed", [False, True])
def test_light_is_dropped(packed: bool, open_page: Open, pages: dict[str, Path], fits: Path, tmp_path: Path) -> None:
    probe = tmp_path / "lamp.hdr"
    probe.write_bytes(radiance(64, packed))
    pages["probed"] = tmp_path / "probed.html"
    run("view", fits / "plastic/model.json", f"--probe={probe}", f"--out={pages['probed']}")
    wanted = picture(open_page("probed", size_of_picture=32), 0)
    page = open_page("alone", size_of_picture=32, light="lamp")
    page.set_input_files("#file", probe)
    wait_for(page, "document.querySelector('#message').textContent === 'Opened lamp.hdr.'")
    finished(page)
    assert np.allclose(picture(page, 0), wanted, rtol=2e-3, atol=1e-4)
    page.locator("#fit summary").click()
    assert "lamp.hdr" in page.inner_text("#facts")
    assert "by lamp.hdr" in page.evaluate("document.getElementById('canvas').ariaLabel")
    page.click("#link")
    wait_for(page, "document.querySelector('#message').textContent.includes('but not lamp.hdr')")


@pytest.mark.parametrize(("cut", "words"), [(40, "not a Radiance picture"), (4000, "is cut off")])
def test_broken_light_gives_one_line(cut: int, words: str, open_page: Open, tmp_path: Path) -> None:
    page = open_page("alone", size_of_picture=16)
    (tmp_path / "broken.hdr").write_bytes(radiance(64, False)[:cut])
    page.set_input_files("#file", tmp_path / "broken.hdr")
    wait_for(page, "document.querySelector('#message').textContent !== ''")
    message = page.inner_text("#message")
    assert message.startswith("broken.hdr: ") and words in message
    finished(page)
