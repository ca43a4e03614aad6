#!/usr/bin/env python3
"""Says how fast a page is without a graphics card: until its first picture, and a frame of 512 x 512 under a lamp.

scripts/page_speed.py PAGE.html      needs Playwright (PyPI) and Debian's chromium

Seconds by the clock, and of processor time, which a busy machine changes less. A frame is as it is at rest, or while
the lamp is dragged, with half as many pixels across; the light alone; or one colour, which is what showing any costs.
"""

from __future__ import annotations

import contextlib
import os
import pathlib
import sys
import tempfile
import time
from collections.abc import Iterator
from typing import Any

from page_picture import SOFTWARE
from playwright.sync_api import sync_playwright

FRAMES = 40
FRAME = f"""async kind => {{
  const r = trilobe.renderer, panels = [{{mode: 'fitted', x: 0, y: 0, size: 512}}];
  r.setMeasured(null);
  r.exposure = 1;
  r.setSize(512);
  r.moving = kind === 'while it moves';
  for (let k = 0; k < {FRAMES}; ++k) {{
    if (kind === 'of one colour') {{
      r.gl.bindFramebuffer(r.gl.FRAMEBUFFER, null);
      r.gl.clearColor(k / {FRAMES}, 0, 0, 1);
      r.gl.clear(r.gl.COLOR_BUFFER_BIT);
    }} else {{
      r.lamp = [0.3 + 0.001 * k, 0.4, 0.86];
      r.restart();
      do r.work(false); while (r.pending);
      if (kind !== 'not shown') r.show(panels, {{wipe: 0.5, stops: 0, mark: null}});
    }}
    await new Promise(next => requestAnimationFrame(next));
  }}
}}"""
EMPTY = """<!DOCTYPE html><title>empty</title><canvas id="c"></canvas><script>
const gl = document.getElementById('c').getContext('webgl2');
gl.clear(gl.COLOR_BUFFER_BIT);
gl.finish();
window.drawn = true;
</script>"""
KINDS = ("at rest", "while it moves", "not shown", "of one colour")


def processor_seconds(mark: str) -> float:
    """Processor seconds of all processes that were started with this in their command line."""
    ticks = 0
    for folder in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if mark in (folder / "cmdline").read_text():
                fields = (folder / "stat").read_text().rsplit(")", 1)[1].split()
                ticks += int(fields[11]) + int(fields[12])
        except OSError:
            continue  # it has ended
    return ticks / os.sysconf("SC_CLK_TCK")


@contextlib.contextmanager
def opened(path: pathlib.Path, until: str) -> Iterator[tuple[Any, str]]:
    """A page in a browser of its own, and the mark of that browser's processes; says how long it took."""
    with tempfile.TemporaryDirectory(prefix="page_speed_") as profile, sync_playwright() as playwright:
        # Playwright's wait_for_function is an eval, which pages do not allow.
        browser = playwright.chromium.launch_persistent_context(
            profile, executable_path="/usr/bin/chromium", args=SOFTWARE, viewport={"width": 1440, "height": 900},
            bypass_csp=True)
        page = browser.pages[0]
        page.wait_for_timeout(1000)
        processor, clock = processor_seconds(profile), time.time()
        page.goto(path.as_uri())
        page.wait_for_function(until, timeout=120000)
        print(f"{path.name} opens in {time.time() - clock:.1f} s, "
              f"{processor_seconds(profile) - processor:.1f} s of processor time")
        yield page, profile
        browser.close()


def main() -> int:
    """Prints a line for each."""
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        empty = pathlib.Path(folder) / "an-empty-canvas.html"
        empty.write_text(EMPTY)
        with opened(empty, "window.drawn"):
            pass
    with opened(pathlib.Path(sys.argv[1]).resolve(), "window.trilobe?.renderer?.shown") as (page, mark):
        page.wait_for_function("!trilobe.renderer.pending", timeout=120000)
        for kind in KINDS:
            page.evaluate(FRAME, kind)  # the first call compiles, and does not count
            processor, clock = processor_seconds(mark), time.time()
            page.evaluate(FRAME, kind)
            print(f"a frame {kind} in {1000 * (time.time() - clock) / FRAMES:.0f} ms, "
                  f"{1000 * (processor_seconds(mark) - processor) / FRAMES:.0f} ms of processor time")
    return 0


if __name__ == "__main__":
    sys.exit(main())
