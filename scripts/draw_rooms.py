#!/usr/bin/env python3
"""Draws src/rooms.txt, what depends on what in src/, into docs/images/rooms.svg.

scripts/draw_rooms.py [--check]     with --check, fails if the picture is not up to date
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PICTURE = ROOT / "docs/images/rooms.svg"
WIDTH, HEIGHT, GAP_X, GAP_Y, MARGIN = 400, 40, 60, 22, 10  # of a box, between boxes, around all


def read_rooms():
    """{room: (rooms that it sees, what is in it)}, lowest first."""
    rooms, text = {}, ""
    for line in (ROOT / "src/rooms.txt").read_text().splitlines():
        if line.startswith("#"):
            text = line[1:].strip()
        elif line:
            name, _, sees = line.partition(":")
            rooms[name] = (sees.split(), text)
    return rooms


def draw(rooms):
    """A room above all that it sees, and an arrow where no other room that it sees sees that, too."""
    below, level, row = {}, {}, {}  # all that a room depends on; its height; rooms of a height
    for name, (sees, _) in rooms.items():
        below[name] = set(sees).union(*(below[other] for other in sees))
        level[name] = 1 + max((level[other] for other in sees), default=-1)
        row.setdefault(level[name], []).append(name)
    columns = max(map(len, row.values()))
    width = 2 * MARGIN + columns * (WIDTH + GAP_X) - GAP_X
    height = 2 * MARGIN + len(row) * (HEIGHT + GAP_Y) - GAP_Y
    place = {name: (MARGIN + row[level[name]].index(name) * (WIDTH + GAP_X),
                    height - MARGIN - HEIGHT - level[name] * (HEIGHT + GAP_Y)) for name in rooms}
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        'font-family="sans-serif" font-size="13">',
        '<defs><marker id="head" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" '
        'markerHeight="8" orient="auto"><path d="M0 0 8 4 0 8z" fill="#555"/></marker></defs>',
        f'<rect width="{width}" height="{height}" fill="#fff"/>']
    for name, (sees, _) in rooms.items():
        for other in sees:
            if any(other in below[between] for between in sees):
                continue
            (x, y), (to_x, to_y) = place[name], place[other]
            if x == to_x:
                path = f"M{x + WIDTH / 2:g} {y + HEIGHT} V{to_y}"
            else:  # between the columns
                x, to_x = (x + WIDTH, to_x) if x < to_x else (x, to_x + WIDTH)
                y, to_y, middle = y + HEIGHT * 0.7, to_y + HEIGHT * 0.3, (x + to_x) / 2
                path = f"M{x} {y:g} C{middle:g} {y:g} {middle:g} {to_y:g} {to_x} {to_y:g}"
            lines.append(f'<path d="{path}" fill="none" stroke="#555" marker-end="url(#head)"/>')
    for name, (_, text) in rooms.items():
        x, y = place[name]
        lines += [
            f'<rect x="{x}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="5" fill="#eef3f8" '
            'stroke="#456"/>',
            f'<text x="{x + 10}" y="{y + 17}" font-weight="bold">{name}</text>',
            f'<text x="{x + 10}" y="{y + 33}">{text}</text>']
    return "\n".join([*lines, "</svg>", ""])


def main():
    svg = draw(read_rooms())
    if sys.argv[1:] != ["--check"]:
        PICTURE.write_text(svg)
    elif PICTURE.read_text() != svg:
        sys.exit(f"{PICTURE.relative_to(ROOT)} is not what src/rooms.txt says; "
                 "run scripts/draw_rooms.py")


main()
