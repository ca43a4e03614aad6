#!/usr/bin/python3
"""Makes a picture small enough for a page: shrink.py PICTURE.png WIDTH, in place, if it is wider than that."""

import sys

from PIL import Image


def main() -> int:
    """Says how it is called where it is called otherwise."""
    if len(sys.argv) != 3 or not sys.argv[2].isdigit():
        sys.exit(__doc__)
    width = int(sys.argv[2])
    picture = Image.open(sys.argv[1]).convert("RGB")
    if picture.width > width:
        picture = picture.resize((width, round(picture.height * width / picture.width)), Image.Resampling.LANCZOS)
        picture.save(sys.argv[1], optimize=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
