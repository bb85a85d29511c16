# SPDX-License-Identifier: Apache-2.0
"""Composes the cells of an example into one picture: contact_sheet.py SHEET.json OUT.png"""

import json
import sys
from pathlib import Path

import matplotlib
from PIL import Image, ImageDraw, ImageFont

BACKDROP, INK, FAINT = (44, 48, 56), (240, 240, 240), (168, 174, 184)
LABELS, TOP, BOTTOM, EDGE = 164, 96, 54, 14
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
    cells = [[Image.open(path).convert("RGBA") for path in paths] for _, _, paths in sheet["rows"]]
    width, height = cells[0][0].size
    size = (
        LABELS + width * len(sheet["columns"]) + EDGE,
        TOP + height * len(cells) + BOTTOM,
    )
    picture = Image.new("RGB", size, BACKDROP)
    draw = ImageDraw.Draw(picture)
    draw.text((EDGE, 14), sheet["title"], INK, font(19, bold=True))
    for column, (caption, detail) in enumerate(sheet["columns"]):
        middle = LABELS + width * (column + 0.5)
        draw.text((middle, 60), caption, INK, font(16), anchor="mm")
        draw.text((middle, 81), detail, FAINT, font(12), anchor="mm")
    for row, (name, note, _) in enumerate(sheet["rows"]):
        top = TOP + height * row
        draw.line((EDGE, top, size[0] - EDGE, top), (70, 76, 88))
        middle = top + height / 2
        draw.text((EDGE, middle - 14), name, INK, font(15, bold=True), anchor="ls")
        draw.multiline_text((EDGE, middle - 6), note, FAINT, font(12), spacing=5)
        for column, cell in enumerate(cells[row]):
            picture.paste(cell, (LABELS + width * column, top), cell)
    legend(draw, sheet, size)
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
        draw.text((left + width / 2, top + height - 16), caption, INK, font(13), anchor="mm")
    return picture


def legend(draw, sheet, size):
    left, right, top = LABELS + 170, size[0] - EDGE - 170, size[1] - 34
    for x in range(left, right):
        draw.line((x, top, x, top + 14), colour_at(sheet["ramp"], (x - left) / (right - left - 1)))
    low, middle, high = sheet["legend"]
    small = font(12)
    draw.text((left - 10, top + 7), low, FAINT, small, anchor="rm")
    draw.text((right + 10, top + 7), high, FAINT, small, anchor="lm")
    draw.text(((left + right) / 2, top - 10), middle, FAINT, small, anchor="mm")


if __name__ == "__main__":
    description, target = sys.argv[1:]
    sheet = json.loads(Path(description).read_text())
    (grid if "cells" in sheet else compose)(sheet).save(target, optimize=True)
