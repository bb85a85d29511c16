# SPDX-License-Identifier: GPL-3.0-or-later
"""Puts our own includes into a shader's text: a Script node has no include folder of its own."""

import re
from pathlib import Path

_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]+"([^"]+)"[^\n]*\n?', re.MULTILINE)
_ONCE = re.compile(r"^[ \t]*#[ \t]*pragma[ \t]+once[^\n]*\n?", re.MULTILINE)


def inlined(path, include_folder=None, _seen=None):
    """Text of a shader with the files of `include/` put in, each once; other includes stay."""
    path = Path(path)
    include_folder = Path(include_folder) if include_folder else path.parent / "include"
    seen = set() if _seen is None else _seen

    def put_in(match):
        included = include_folder / match.group(1)
        if not included.is_file():
            return match.group(0)
        if included in seen:
            return ""
        seen.add(included)
        return inlined(included, include_folder, seen)

    return _INCLUDE.sub(put_in, _ONCE.sub("", path.read_text(encoding="utf-8")))
