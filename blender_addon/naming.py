# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of the baked files: DIR/<object>_<pass>.<frame>.exr, with UDIM .<udim>.<frame>.exr."""

import hashlib
import re

_UNSAFE = re.compile(r"[^A-Za-z0-9_-]")
# A name that already looks like one of ours with a hash must get its own hash, or it could meet it.
_HASHED = re.compile(r"-[0-9a-f]{6}$")
_WINDOWS_DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)$", re.IGNORECASE)
# File systems allow 255 bytes; pass, tile and frame numbers need room.
_LONGEST = 120


def file_stem(name, library="", others=()):
    """The part of a file name that stands for an object.

    A safe name stays as it is; every other one gets a short hash of its true name, so that two
    different names never share a file. `others` are the (name, library) of the objects of the file:
    the same name in other letter case is told apart too, and that of linked objects from the one of
    the file's own, which keeps it.
    """
    safe = _UNSAFE.sub("_", name)[:_LONGEST]
    ambiguous = any(
        other.casefold() == name.casefold()
        for other, origin in others
        if (other, origin) != (name, library) and (library or other != name)
    )
    if safe == name and not ambiguous and not _HASHED.search(name) and not _is_device(name):
        return name
    digest = hashlib.sha256(f"{name}\0{library}".encode()).hexdigest()[:6]
    return f"{safe}-{digest}"


def _is_device(name):
    return _WINDOWS_DEVICES.match(name) is not None


def udim(tile):
    """The UDIM number of the tile (u, v): (0, 0) is 1001."""
    return 1001 + tile[0] + 10 * tile[1]


def is_udim(tiles):
    """Whether the files carry tile numbers: the tiles are more than the plain unit square."""
    return list(tiles) != [(0, 0)]


def file_name(stem, pass_name, frame, tile=None):
    """The file of a frame; tile None: no tile number."""
    number = "" if tile is None else f".{udim(tile)}"
    return f"{stem}_{pass_name}{number}.{frame:04d}.exr"
