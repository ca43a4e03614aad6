#!/usr/bin/env python3
"""Draws src/rooms.txt, what depends on what in src/: its groups into docs/images/groups.svg, and the rooms of
each group into docs/images/rooms.svg.

scripts/draw_rooms.py [--check]     with --check, fails if the pictures are not up to date
"""

import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
WIDTH, HEIGHT, GAP_X, GAP_Y, MARGIN = 400, 40, 60, 22, 10  # sizes of a box, between boxes, around all
FRAME, TITLE = 14, 24  # around the rooms of a group, and above them


class Box:
    """A group or a room: what it sees, what is in it, and of a group its rooms."""

    def __init__(self, sees, text):
        self.sees, self.text, self.rooms = sees.split(), text, {}


def read_groups():
    """{group: Box}, lowest first."""
    groups, text = {}, ""
    for line in (ROOT / "src/rooms.txt").read_text().splitlines():
        if line.startswith("#"):
            text = line[1:].strip()
        elif line:
            name, _, sees = line.removeprefix("== ").partition(":")
            if line.startswith("== "):
                group = groups[name] = Box(sees, text)
            else:
                group.rooms[name] = Box(sees, text)
    return groups


def places(boxes):
    """(column, level) of each box, above all boxes beside it that it sees; and all that a box depends on."""
    below, level, row = {}, {}, {}
    for name, box in boxes.items():
        seen = [other for other in box.sees if other in boxes]
        below[name] = set(seen).union(*(below[other] for other in seen))
        level[name] = 1 + max((level[other] for other in seen), default=-1)
        row.setdefault(level[name], []).append(name)
    return {name: (row[level[name]].index(name), level[name]) for name in boxes}, below


def draw(boxes, left, top):
    """The lines of boxes and of an arrow wherever no other box that one sees sees that, too; width; height."""
    place, below = places(boxes)
    columns, rows = (1 + max(where[i] for where in place.values()) for i in (0, 1))
    width = columns * (WIDTH + GAP_X) - GAP_X
    height = rows * (HEIGHT + GAP_Y) - GAP_Y
    at = {name: (left + column * (WIDTH + GAP_X), top + height - HEIGHT - level * (HEIGHT + GAP_Y))
          for name, (column, level) in place.items()}
    lines = []
    for name, box in boxes.items():
        for other in box.sees:
            if other not in boxes or any(other in below[between] for between in box.sees if between in boxes):
                continue
            (x, y), (to_x, to_y) = at[name], at[other]
            if x == to_x and y + HEIGHT + GAP_Y == to_y:
                path = f"M{x + WIDTH / 2:g} {y + HEIGHT} V{to_y}"
            elif x == to_x:  # around what stands between
                y, to_y, side = y + HEIGHT * 0.7, to_y + HEIGHT * 0.3, x + WIDTH + GAP_X / 2
                path = f"M{x + WIDTH} {y:g} C{side:g} {y:g} {side:g} {to_y:g} {x + WIDTH} {to_y:g}"
            else:  # between the columns
                x, to_x = (x + WIDTH, to_x) if x < to_x else (x, to_x + WIDTH)
                y, to_y, middle = y + HEIGHT * 0.7, to_y + HEIGHT * 0.3, (x + to_x) / 2
                path = f"M{x} {y:g} C{middle:g} {y:g} {middle:g} {to_y:g} {to_x} {to_y:g}"
            lines.append(f'<path d="{path}" fill="none" stroke="#555" marker-end="url(#head)"/>')
    for name, box in boxes.items():
        x, y = at[name]
        lines += [
            f'<rect x="{x}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="5" fill="#eef3f8" stroke="#456"/>',
            f'<text x="{x + 10}" y="{y + 17}" font-weight="bold">{name}</text>',
            f'<text x="{x + 10}" y="{y + 33}">{box.text}</text>']
    return lines, width, height


def picture(lines, width, height):
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" '
        'font-family="sans-serif" font-size="13">',
        '<defs><marker id="head" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="8" '
        'markerHeight="8" orient="auto"><path d="M0 0 8 4 0 8z" fill="#555"/></marker></defs>',
        f'<rect width="{width}" height="{height}" fill="#fff"/>', *lines, "</svg>", ""])


def picture_of_groups(groups):
    lines, width, height = draw(groups, MARGIN, MARGIN)
    return picture(lines, width + 2 * MARGIN, height + 2 * MARGIN)


def picture_of_rooms(groups):
    """A frame a group, the lowest at the bottom, with its rooms and arrows between these."""
    lines, top, most = [], MARGIN, 0
    for name, group in reversed(groups.items()):
        drawn, width, height = draw(group.rooms, MARGIN + FRAME, top + TITLE + FRAME)
        frame = width + 2 * FRAME, height + TITLE + 2 * FRAME
        sees = f"; sees {', '.join(group.sees)}" if group.sees else ""
        lines += [
            f'<rect x="{MARGIN}" y="{top}" width="{frame[0]}" height="{frame[1]}" rx="8" fill="#fafafa" stroke="#999"/>',
            f'<text x="{MARGIN + FRAME}" y="{top + TITLE}" font-size="16" font-weight="bold">{name}'
            f'<tspan font-size="13" font-weight="normal">: {group.text}{sees}</tspan></text>', *drawn]
        top += frame[1] + MARGIN
        most = max(most, frame[0])
    return picture(lines, most + 2 * MARGIN, top)


def main():
    groups = read_groups()
    for name, svg in {"groups": picture_of_groups(groups), "rooms": picture_of_rooms(groups)}.items():
        path = ROOT / f"docs/images/{name}.svg"
        if sys.argv[1:] != ["--check"]:
            path.write_text(svg)
        elif not path.exists() or path.read_text() != svg:
            sys.exit(f"{path.relative_to(ROOT)} is not what src/rooms.txt says; run scripts/draw_rooms.py")


main()
