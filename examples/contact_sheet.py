# SPDX-License-Identifier: Apache-2.0
"""Composes the cells of an example into one picture: contact_sheet.py SHEET.json OUT.png"""

import json
import sys
from pathlib import Path

import matplotlib
from PIL import Image, ImageDraw, ImageFont

BACKDROP, INK, FAINT = (44, 48, 56), (240, 240, 240), (168, 174, 184)
LABELS, EDGE, TITLE, CAPTIONS, LEGEND = 164, 14, 44, 52, 54
FONTS = Path(matplotlib.get_data_path()) / "fonts" / "ttf"


def font(size, bold=False):
    return ImageFont.truetype(
        str(FONTS / ("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf")), size
    )


def colour_at(ramp, x):
    """The ramp as Blender's ColorRamp shows it: linear in scene-linear light."""

    def decode(c):
        return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4

    def encode(c):
        return 12.92 * c if c <= 0.0031308 else 1.055 * c ** (1 / 2.4) - 0.055

    place = x * (len(ramp) - 1)
    left = min(int(place), len(ramp) - 2)
    part = place - left
    pairs = zip(ramp[left], ramp[left + 1], strict=True)
    return tuple(round(255 * encode(decode(a) * (1 - part) + decode(b) * part)) for a, b in pairs)


def compose(sheet):
    rows = sheet["rows"]
    left = LABELS if any(row.get("name") for row in rows) else EDGE
    cells = [[Image.open(path).convert("RGBA") for path in row["cells"]] for row in rows]
    gap = sheet.get("gap", 0)
    widths = [sum(cell.width for cell in row) + gap * (len(row) - 1) for row in cells]
    tops, bottom = [], TITLE
    for row, row_cells in zip(rows, cells, strict=True):
        tops.append(bottom + (CAPTIONS if "captions" in row else 0))
        bottom = tops[-1] + max(cell.height for cell in row_cells) + gap
    legend_room = LEGEND if "legend" in sheet else EDGE
    size = (left + max(widths) + EDGE, bottom - gap + legend_room)
    picture = Image.new("RGB", size, BACKDROP)
    draw = ImageDraw.Draw(picture)
    draw.text((EDGE, 14), sheet["title"], INK, font(19, bold=True))
    for row, row_cells, top in zip(rows, cells, tops, strict=True):
        if not gap:
            draw.line((EDGE, top, size[0] - EDGE, top), (70, 76, 88))
        middle = top + row_cells[0].height / 2
        draw.text((EDGE, middle - 14), row.get("name", ""), INK, font(15, bold=True), anchor="ls")
        draw.multiline_text((EDGE, middle - 6), row.get("note", ""), FAINT, font(12), spacing=5)
        x = left
        for column, cell in enumerate(row_cells):
            if "captions" in row:
                caption, detail = row["captions"][column]
                centre = x + cell.width / 2
                draw.text((centre, top - 36), caption, INK, font(16), anchor="mm")
                draw.text((centre, top - 15), detail, FAINT, font(12), anchor="mm")
            picture.paste(cell, (x, top), cell)
            if "insets" in row:
                inset(picture, x + cell.width, top, row["insets"][column])
            x += cell.width + gap
    if "legend" in sheet:
        legend(draw, sheet["legend"], left, size)
    return picture


def grid(sheet):
    """Captioned cells, left to right and down."""
    pictures = [Image.open(path).convert("RGBA") for _, path in sheet["cells"]]
    width, height = pictures[0].size
    height += 30
    columns = sheet["columns"]
    rows = -(-len(pictures) // columns)
    picture = Image.new("RGB", (width * columns, 56 + height * rows), BACKDROP)
    draw = ImageDraw.Draw(picture)
    draw.text((EDGE, 14), sheet["title"], INK, font(19, bold=True))
    for index, ((caption, _), cell) in enumerate(zip(sheet["cells"], pictures, strict=True)):
        left, top = width * (index % columns), 56 + height * (index // columns)
        picture.paste(cell, (left, top), cell)
        size = 13
        while font(size).getlength(caption) > width - 8:
            size -= 1
        draw.text((left + width / 2, top + height - 16), caption, INK, font(size), anchor="mm")
    return picture


def inset(picture, right, top, lines):
    """A sketch in the cell's upper right corner: lines of points in the unit square, y up."""
    side, margin = 74, 10
    width = side + 2 * margin
    box = (right - width, top, right, top + width)
    backdrop = Image.new("RGB", (width, width), BACKDROP)
    picture.paste(Image.blend(picture.crop(box), backdrop, 0.75), box)
    draw = ImageDraw.Draw(picture)
    for line in lines:
        draw.line([(box[0] + margin + side * x, box[3] - margin - side * y) for x, y in line], INK)


def legend(draw, legend, labels, size):
    left, right, top = labels + 170, size[0] - EDGE - 170, size[1] - 34
    for x in range(left, right):
        draw.line((x, top, x, top + 14), colour_at(legend["ramp"], (x - left) / (right - left - 1)))
    low, middle, high = legend["words"]
    small = font(12)
    draw.text((left - 10, top + 7), low, FAINT, small, anchor="rm")
    draw.text((right + 10, top + 7), high, FAINT, small, anchor="lm")
    draw.text(((left + right) / 2, top - 10), middle, FAINT, small, anchor="mm")


if __name__ == "__main__":
    description, target = sys.argv[1:]
    sheet = json.loads(Path(description).read_text())
    (grid if "cells" in sheet else compose)(sheet).save(target, optimize=True)
