"""A page in use: by keys, by a finger, heard, on paper."""

from __future__ import annotations

import re
from typing import Any

import pytest

from conftest import Open, finished, wait_for


def test_a_row_of_key_presses_is_undone_as_one(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16, view="fitted")
    page.focus("input[aria-label='Lobe 2: strength']")
    for _ in range(35):
        page.keyboard.press("ArrowRight")
    strength = "trilobe.state.edit.lobes[1].gain"
    assert page.evaluate(strength) > 1
    page.click("#undo")
    assert page.evaluate(strength) == 1
    assert page.locator("#undo").is_disabled()
    page.click("#redo")
    assert page.evaluate(strength) > 1


def test_the_object_is_turned(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16, view="fitted", object="knot")
    page.focus("#canvas")
    page.keyboard.press("Alt+ArrowRight")
    assert page.evaluate("trilobe.renderer.turn[0]") > 0
    page.get_by_text("Object", exact=True).last.click()
    before = page.evaluate("trilobe.renderer.turn")
    box = page.locator("#canvas").bounding_box()
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] / 2 + 80, box["y"] + 200, steps=4)
    page.mouse.up()
    after = page.evaluate("trilobe.renderer.turn")
    assert after[0] > before[0] + 0.1
    # A sphere of an isotropic material says why it does not turn.
    page.select_option("#object", "sphere")
    page.focus("#canvas")
    page.keyboard.press("Alt+ArrowRight")
    assert "looks alike from all sides" in page.inner_text("#message")


def test_an_anisotropic_sphere_is_turned(open_page: Open) -> None:
    page = open_page("shot_silk", size_of_picture=16, view="fitted")
    page.focus("#canvas")
    page.keyboard.press("Alt+ArrowUp")
    finished(page)
    assert page.evaluate("trilobe.renderer.turn[1]") > 0
    tangent = page.evaluate("trilobe.renderer.surfaceAt(0.4, 0.4).tangent")
    assert abs(tangent[1]) > 0.01  # no longer about the vertical


def test_pictures_and_charts_are_told_in_words(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16)
    wait_for(page, "!trilobe.page.chartsStale")
    label = page.evaluate("document.getElementById('canvas').ariaLabel")
    assert "plastic on a sphere" in label and "ΔE" in label
    for chart in ("chart-d", "chart-f", "chart-g", "polar", "heat"):
        assert re.search(r"\d", page.evaluate(f"document.getElementById('{chart}').ariaLabel")), chart
    page.focus("#canvas")
    page.keyboard.press("Shift+ArrowUp")
    wait_for(page, "document.getElementById('heard').textContent.includes('ρ fitted')")
    angles = page.inner_text("#numbers").split("\n")[0]
    assert re.fullmatch(r"angles\tθh [\d.]{1,4}°, θd [\d.]{1,4}°, θi [\d.]{1,4}°, θo [\d.]{1,4}°", angles)


@pytest.mark.parametrize("size", [(1400, 900), (390, 844)])
def test_targets_are_large_enough(size: tuple[int, int], open_page: Open) -> None:
    page = open_page("plastic", size=size, size_of_picture=16)
    small = page.evaluate(
        "Array.from(document.querySelectorAll('button, select, summary, input[type=checkbox], input[type=color],"
        " input[type=range], .segments label'))"
        ".map(e => [e.getBoundingClientRect(), e]).filter(([r]) => r.width > 0 && Math.min(r.width, r.height) < 24)"
        ".map(([r, e]) => `${e.outerHTML.slice(0, 60)}: ${r.width} x ${r.height}`)")
    assert small == []


def contrast(page: Any, name: str, ground: str) -> float:
    codes = page.evaluate(f"['{name}', '{ground}'].map(c =>"
                          " getComputedStyle(document.documentElement).getPropertyValue(c))")

    def luminance(code: str) -> float:
        digits = code.strip().lstrip("#")
        digits = "".join(2 * d for d in digits) if len(digits) == 3 else digits
        light = [int(digits[k : k + 2], 16) / 255 for k in (0, 2, 4)]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in light]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted(luminance(code) for code in codes)
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_words_stand_out(scheme: str, open_page: Open) -> None:
    page = open_page("plastic", scheme=scheme, size_of_picture=16)
    for name in ("--text", "--muted", "--good", "--fair", "--warn", "--bad"):
        for ground in ("--page", "--surface"):
            assert contrast(page, name, ground) >= 4.5, f"{name} on {ground}"


def test_a_finger_scrolls_and_the_numbers_stay_in_sight(open_page: Open) -> None:
    page = open_page("plastic", size=(390, 844), size_of_picture=16)
    assert page.evaluate("getComputedStyle(document.getElementById('canvas')).touchAction").startswith("pan-y")
    box = page.locator("#canvas").bounding_box()
    page.mouse.move(box["x"] + 90, box["y"] + 90)
    wait_for(page, "trilobe.page.point !== null")
    seen = page.locator("#readout").bounding_box()
    assert seen["y"] >= 0 and seen["y"] + seen["height"] <= 844
    assert page.evaluate("document.documentElement.scrollHeight") > 2 * 844


def test_it_is_printed_light_on_two_pages(open_page: Open) -> None:
    page = open_page("plastic", scheme="dark", size_of_picture=16)
    wait_for(page, "!trilobe.page.chartsStale")
    pdf = page.pdf(format="A4")
    assert len(re.findall(rb"/Type\s*/Page\b", pdf)) == 2
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert page.evaluate("document.documentElement.dataset.theme") == "light"
    page.emulate_media(media="print")
    for hidden in ("#theme", "#save", "#edit", "#views", "#lobes button"):
        assert not page.locator(hidden).first.is_visible(), hidden
    page.emulate_media(media="screen")
    page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    assert page.evaluate("document.documentElement.dataset.theme") == "dark"


def test_what_takes_long_is_finished_and_said(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16, view="fitted", object="knot")
    page.evaluate("trilobe.renderer.patience = 0; trilobe.renderer.setSize(48); trilobe.state.size = 48")
    wait_for(page, "document.getElementById('progress').textContent.startsWith('finer: ')")
    finished(page)
    assert page.evaluate("trilobe.renderer.shown.size") == 48
    wait_for(page, "document.getElementById('progress').textContent === ''")
