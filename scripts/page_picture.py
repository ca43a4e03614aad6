#!/usr/bin/env python3
"""Takes a picture of a page that trilobe wrote, in Debian's chromium, which Playwright (PyPI) drives.

scripts/page_picture.py PAGE.html PICTURE.png [--size=1440x900] [--dark] [--seconds=20] [--point=0.19,0.33]
"""

from __future__ import annotations

import argparse
import pathlib
import sys

SEEN_IMAGES = ("[...document.images].filter(i => i.getBoundingClientRect().top < innerHeight)"
               ".every(i => i.complete && i.naturalWidth > 0)")
SOFTWARE = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"]


def main() -> int:
    """Writes the picture; says in one line what is missing."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=pathlib.Path)
    parser.add_argument("picture", type=pathlib.Path)
    parser.add_argument("--size", default="1440x900", help="of the window, in pixels")
    parser.add_argument("--dark", action="store_true", help="the dark page")
    parser.add_argument("--seconds", type=float, default=60, help="at most so long for the object's picture")
    parser.add_argument("--point", default="0.2,0.33", help="where the pointer stands, in parts of the canvas")
    options = parser.parse_args()
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        sys.exit("page_picture.py needs Playwright: pip install playwright, and Debian's package chromium")
    width, height = map(int, options.size.split("x"))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=SOFTWARE)
        # Playwright's wait_for_function is an eval, which pages do not allow.
        page = browser.new_page(viewport={"width": width, "height": height}, bypass_csp=True,
                                color_scheme="dark" if options.dark else "light")
        page.goto(options.page.resolve().as_uri())
        if page.locator("#canvas").count() == 1:
            milliseconds = 1000 * options.seconds
            page.wait_for_function("window.trilobe?.renderer?.shown", timeout=milliseconds)
            page.wait_for_function("!trilobe.renderer.pending", timeout=milliseconds)
            box = page.locator("#canvas").bounding_box()
            x, y = map(float, options.point.split(","))
            page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
            page.wait_for_timeout(300)
        page.wait_for_function(SEEN_IMAGES)  # which load as they come into sight
        page.screenshot(path=options.picture)
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
