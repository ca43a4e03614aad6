#!/usr/bin/python3
"""Checks that the pictures of README.md and docs are what the commands beside them make.

Above each picture stands a comment with the command, which leaves a file of the picture's name in
the folder where it runs:

    <!-- made by: trilobe info chm_mint_rgb.bsdf --out=. -->
    ![What was measured](images/measured.png)

"made nightly by" marks one that takes long. Where a picture stands on several pages, one of them
has the comment. Pictures of the same command are made by running it once. Measured files that a
command names are looked for in the folder of --data; without them the picture is not checked, and
a line says so. What experiments publish is not looked at.
"""

import argparse
import os
import pathlib
import re
import sys
import tempfile
from typing import NamedTuple

import numpy as np
import page_commands
from PIL import Image

MADE = re.compile(r"<!-- made (nightly )?by:((?:(?!-->).)*)-->\s*\Z", re.DOTALL)
PICTURE = re.compile(r"!\[[^]]*\]\(([^)\s]+\.png)\)")
# On another processor commands give the same figures in all the digits that pictures have, so only
# edges of letters and lines may differ. A pixel does from VISIBLE of 255 on; one of 100,000 may.
VISIBLE, SHARE = 32, 1e-5


class Made(NamedTuple):
    """The command that makes a picture, and the page that has it."""
    command: str
    nightly: bool
    page: str


def pictures(root: pathlib.Path) -> tuple[dict[pathlib.Path, Made], list[str]]:
    """The commands of all pictures of the pages, and errors in what pages say of them."""
    shown: dict[pathlib.Path, str] = {}
    made: dict[pathlib.Path, Made] = {}
    wrong: list[str] = []
    folder = root / "docs/images"
    for page in [root / "README.md", *sorted((root / "docs").rglob("*.md"))]:
        text, name = page.read_text(), str(page.relative_to(root))
        for link in PICTURE.finditer(text):
            picture = pathlib.Path(os.path.normpath(page.parent / link[1]))
            if picture.parent != folder:
                continue
            shown.setdefault(picture, name)
            comment = MADE.search(text[:link.start()])
            if not comment:
                continue
            new = Made(" ".join(comment[2].split()), bool(comment[1]), name)
            old = made.setdefault(picture, new)
            if new.command != old.command:
                wrong.append(f"{old.page} and {name} make {picture.name} by different commands")
    wrong += [f"{name} shows {picture.name} without the command that makes it"
              for picture, name in shown.items() if picture not in made]
    wrong += [f"no page shows {picture.relative_to(root)}"
              for picture in sorted(folder.glob("*.png")) if picture not in shown]
    return made, wrong


def difference(one: pathlib.Path, other: pathlib.Path) -> str:
    """The visible difference between two pictures, in words; empty if there is none."""
    pixels = [np.asarray(Image.open(path).convert("RGB")).astype(int) for path in (one, other)]
    if pixels[0].shape != pixels[1].shape:
        return " by ".join(map(str, pixels[1].shape[1::-1])) + " pixels instead of " + \
            " by ".join(map(str, pixels[0].shape[1::-1]))
    share = float(np.mean(np.abs(pixels[0] - pixels[1]).max(axis=2) >= VISIBLE))
    return f"{100 * share:.2g} % of the pixels differ" if share > SHARE else ""


def make(how: Made, names: list[str], data: pathlib.Path | None,
         root: pathlib.Path) -> dict[str, tuple[bytes, str]]:
    """The pictures that the command makes, or why there is none."""
    results = {}
    with page_commands.run(how.command, root, data) as done:
        for picture in names:
            result = done.folder / picture
            if done.absent:
                results[picture] = (b"", f"not checked: {picture} ({done.absent} is not in the folder of --data)")
            elif not done.succeeded or not result.is_file():
                results[picture] = (b"", f"{how.page}: `{how.command}` makes no {picture}:\n{done.output}")
            else:
                results[picture] = (result.read_bytes(), "")
    return results


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="leave out what is made nightly")
    parser.add_argument("--make", action="store_true", help="replace pictures that differ")
    parser.add_argument("--data", type=pathlib.Path, help="where measured files lie, at any depth")
    parser.add_argument("--root", type=pathlib.Path, help="of the repository",
                        default=pathlib.Path(__file__).resolve().parent.parent)
    parser.add_argument("pictures", nargs="*", help="names of the pictures to look at (all)")
    options = parser.parse_args()
    root = options.root.resolve()

    made, wrong = pictures(root)
    looked_at = {picture: how for picture, how in sorted(made.items())
                 if not (options.quick and how.nightly)
                 and (not options.pictures or picture.name in options.pictures)}
    results: dict[str, dict[str, tuple[bytes, str]]] = {}
    for picture, how in looked_at.items():
        if how.command not in results:
            names = [one.name for one, by in looked_at.items() if by.command == how.command]
            results[how.command] = make(how, names, options.data, root)
        new, reason = results[how.command][picture.name]
        if not new:
            print(reason, flush=True)
            if not reason.startswith("not checked"):
                wrong.append(f"{picture.name} could not be made")
            continue
        with tempfile.NamedTemporaryFile(suffix=".png") as file:
            file.write(new)
            file.flush()
            differs = "it is new"
            if picture.exists():
                differs = difference(picture, pathlib.Path(file.name))
        if not differs:
            print(f"as `{how.command}` makes it: {picture.name}", flush=True)
        elif options.make:
            picture.write_bytes(new)
            print(f"made again: {picture.name} ({differs})", flush=True)
        else:
            wrong.append(f"{picture.name} is not what `{how.command}` makes ({differs}): "
                         f"scripts/check_pictures.py --make {picture.name} replaces it")
    for line in wrong:
        print(line, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
