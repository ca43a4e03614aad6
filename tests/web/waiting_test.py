"""What a page shows while its picture is not done: charts do not wait for it, and it only gets finer."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from conftest import Open, finished, wait_for

HELD = "window.held = []; window.own = requestAnimationFrame; window.requestAnimationFrame = f => window.held.push(f);"
RELEASED = "window.requestAnimationFrame = window.own; window.held.splice(0).forEach(f => requestAnimationFrame(f))"


def test_charts_do_not_wait_for_the_picture(pages: dict[str, Path], browser: Any) -> None:
    context = browser.new_context(viewport={"width": 1680, "height": 1050}, device_scale_factor=2)
    page = context.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.goto(f"file://{pages['plastic']}")
    wait_for(page, "window.trilobe?.page.albedo?.length === 19")
    # As it is by the eye's size, without a graphics card.
    assert page.evaluate("trilobe.renderer.pending")
    assert page.locator("#albedo path").count() >= 3
    with page.expect_download() as download:
        page.click("button[aria-label='Albedo as CSV']")
    assert len(Path(download.value.path()).read_text().splitlines()) > 57
    for _ in range(3):
        page.locator("#albedo").dblclick()
    assert complaints == []
    context.close()


def test_buttons_wait_for_what_they_save(pages: dict[str, Path], browser: Any) -> None:
    page = browser.new_page()
    complaints: list[str] = []
    page.on("pageerror", lambda error: complaints.append(str(error)))
    page.add_init_script(HELD)
    page.goto(f"file://{pages['alone']}")
    wait_for(page, "window.held?.length > 0")
    buttons = "Array.from(document.querySelectorAll('#factors .chart-tools button, #light .chart-tools button'))"
    assert page.evaluate(f"{buttons}.map(b => b.disabled)") == [True] * 15
    page.evaluate(f"{buttons}.forEach(b => b.click())")
    for chart in ("chart-d", "slice", "albedo"):
        page.locator(f"#{chart}").dispatch_event("dblclick")
    page.evaluate(RELEASED)
    wait_for(page, "document.getElementById('albedo-why').textContent.startsWith('Being summed')"
                   " || trilobe.page.albedo?.length === 19")
    wait_for(page, "trilobe.page.albedo?.length === 19")
    assert page.evaluate(f"{buttons}.every(b => !b.disabled)") and page.inner_text("#albedo-why") == ""
    assert complaints == []
    page.close()


def test_a_missing_albedo_is_explained(open_page: Open, tmp_path: Path) -> None:
    page = open_page("alone", size_of_picture=16)
    rows = [f"{i},0,{o},{p},0.1,0.1,0.1" for i in (0, 20, 40) for o in (0, 20, 40) for p in (0, 90, 180)]
    (tmp_path / "few.csv").write_text("\n".join(["theta_i,phi_i,theta_o,phi_o,r,g,b", *rows]))
    page.set_input_files("#file", tmp_path / "few.csv")
    wait_for(page, "document.getElementById('albedo-why').textContent.includes('scattered samples')")


def test_progress_never_falls(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=16, view="fitted", object="knot")
    page.evaluate(
        "window.told = []; new MutationObserver(() => told.push(document.getElementById('progress').textContent))"
        ".observe(document.getElementById('progress'), {childList: true, subtree: true, characterData: true});"
        "trilobe.renderer.patience = 0; trilobe.renderer.rate = 2e5; trilobe.state.size = 192;"
        "trilobe.renderer.restart(); trilobe.renderer.setSize(192)")
    finished(page, 180)
    wait_for(page, "told.at(-1) === ''")
    parts = [int(re.findall(r"(\d+) %", text)[0]) for text in page.evaluate("told") if text]
    assert len(parts) > 5 and parts == sorted(parts) and parts[-1] > 90


def test_a_window_that_changes_makes_nothing_coarser(open_page: Open) -> None:
    page = open_page("plastic", size_of_picture=150, view="fitted")
    sizes = page.evaluate(
        """async () => {
          const r = trilobe.renderer, sizes = [r.shown.size];
          r.setSize(trilobe.state.size = 140);
          for (let k = 0; k < 2000 && r.pending; ++k) {
            await new Promise(next => requestAnimationFrame(next));
            sizes.push(r.shown.size);
          }
          return sizes;
        }""")
    assert sizes[0] == 150 and sizes[-1] == 140 and set(sizes) == {150, 140}
    # Another light is another picture.
    page.locator("#lights input[value=lamp]").check(force=True)
    finished(page)
    assert page.evaluate("trilobe.renderer.shown.size") == 140
