# SPDX-License-Identifier: GPL-3.0-or-later
"""Frame lists as text: 7, 1-24, 1-10,20, 1-24x2."""

import re

_PART = re.compile(r"(-?\d+)(?:-(-?\d+)(?:x(\d+))?)?$")
# A slip of the keyboard should not fill the memory.
_MOST = 1_000_000


def parse(text):
    """The sorted frames of a list such as 1-10,20 or 1-24x2; raises ValueError."""
    frames = set()
    for part in text.split(","):
        match = _PART.match(part.strip())
        if match is None:
            raise ValueError(f"frames are given as 7, 1-24, 1-10,20 or 1-24x2, not {text!r}")
        first = int(match[1])
        last = int(match[2]) if match[2] is not None else first
        step = int(match[3]) if match[3] is not None else 1
        if last < first or step < 1:
            raise ValueError(f"{part.strip()!r} holds no frame")
        if (last - first) // step >= _MOST:
            raise ValueError(f"{part.strip()!r} holds more than {_MOST} frames")
        frames.update(range(first, last + 1, step))
    return sorted(frames)
