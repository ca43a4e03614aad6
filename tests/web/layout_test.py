"""Where things stand: nothing is covered, cut or too small, in windows of several sizes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from conftest import Open, run, wait_for

# Of the element with the focus: what it is, and whether something else lies over it or it is out of sight.
FOCUSED = """() => {
  const e = document.activeElement;
  if (!e || e === document.body) return null;
  const target = e.closest('.segments label') ?? e, box = target.getBoundingClientRect();
  const x = (box.left + box.right) / 2;
  const covered = [box.top + 3, (box.top + box.bottom) / 2, box.bottom - 3].some(y => {
    if (y < 0 || y >= innerHeight) return true;
    const hit = document.elementFromPoint(x, y);
    return hit && !target.contains(hit) && !hit.contains(target) && !hit.closest('label')?.contains(e);
  });
  return [e.outerHTML.slice(0, 80), covered];
}"""


def tab_stops(page: Any, key: str) -> list[tuple[str, bool]]:
    page.evaluate("scrollTo(0, 0); document.activeElement.blur()")
    stops: list[tuple[str, bool]] = []
    while True:
        page.keyboard.press(key)
        stop = page.evaluate(FOCUSED)
        if stop is None or (stops and stop[0] == stops[0][0]):
            return stops
        stops.append(tuple(stop))
        assert len(stops) < 200


@pytest.mark.parametrize("size", [(1280, 800), (1100, 800), (390, 844)])
@pytest.mark.parametrize("view", ["side", "fitted"])
def test_nothing_covers_what_the_keyboard_has_got_to(size: tuple[int, int], view: str, open_page: Open) -> None:
    page = open_page("plastic", size=size, size_of_picture=16, view=view)
    wait_for(page, "!trilobe.page.chartsStale")
    for key in ("Tab", "Shift+Tab"):
        stops = tab_stops(page, key)
        assert len(stops) > 50
        assert [name for name, covered in stops if covered] == [], key


@pytest.mark.parametrize("size", [(1280, 800), (1100, 800)])
def test_no_column_is_empty(size: tuple[int, int], open_page: Open) -> None:
    page = open_page("plastic", size=size, size_of_picture=16)
    wait_for(page, "!trilobe.page.chartsStale")
    ends = page.evaluate("Array.from(document.querySelectorAll('.column'),"
                         " c => c.lastElementChild.getBoundingClientRect().bottom)")
    assert min(ends) > 0.8 * max(ends)


@pytest.mark.parametrize("width", [390, 360])
def test_five_views_are_one_row_on_a_phone(width: int, open_page: Open) -> None:
    page = open_page("plastic", size=(width, 740), size_of_picture=16)
    boxes = [page.locator("#views label").nth(k).bounding_box() for k in range(5)]
    assert len({round(box["y"]) for box in boxes}) == 1
    assert boxes[-1]["x"] + boxes[-1]["width"] <= width and min(box["height"] for box in boxes) >= 24


@pytest.fixture(scope="session")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study of many problems, whose table is wide."""
    folder = tmp_path_factory.mktemp("study")
    run("synth", "felt@6x6", f"--out={folder}/felt.csv")
    names = ("blue-metallic-paint2", "special-walnut-224", "polyurethane-foam", "dark-specular-fabric", "chrome-steel")
    for name in names:
        (folder / f"{name}.csv").write_text((folder / "felt.csv").read_text())
    run("study", folder, "--solvers=awls_accelerated,lm", "--runs=1", "--max_iterations=1", "--lobes=1",
        f"--out={folder}/out")
    return folder / "out/index.html"


@pytest.mark.parametrize("width", [1280, 1100, 390])
def test_tables_of_a_study_are_not_cut(width: int, study: Path, browser: Any) -> None:
    page = browser.new_page(viewport={"width": width, "height": 800})
    page.goto(f"file://{study}")
    page.evaluate("document.querySelectorAll('details').forEach(d => (d.open = true))")
    assert page.evaluate("document.documentElement.scrollWidth") <= width
    tables = page.locator(".scroll")
    wide = page.evaluate("Array.from(document.querySelectorAll('.scroll'), s => s.scrollWidth > s.clientWidth)")
    assert not any(wide) or width < 1000
    if width < 1000:
        # By keys it is moved to its end, under its first column.
        first = wide.index(True)
        tables.nth(first).focus()
        for _ in range(60):
            page.keyboard.press("ArrowRight")
        page.wait_for_timeout(500)
        left, end = tables.nth(first).evaluate("s => [s.scrollLeft, s.scrollWidth - s.clientWidth]")
        assert left == pytest.approx(end, abs=2)
        method = tables.nth(first).locator("tbody th").first.bounding_box()
        assert 0 <= method["x"] < 40
    small = page.evaluate(
        "Array.from(document.querySelectorAll('a, summary, button')).map(e => [e.getBoundingClientRect(), e])"
        ".filter(([r]) => r.width > 0 && Math.min(r.width, r.height) < 24).map(([, e]) => e.outerHTML.slice(0, 60))")
    assert small == []
    page.close()
