# SPDX-License-Identifier: GPL-3.0-or-later
"""May this data-block be changed so that the change is still there after saving?"""

REFUSAL = "Make a library override first"
NODES_REFUSAL = "nodes of linked and overridden materials cannot be changed: make it local first"


def is_writable(data):
    """False for linked data: Blender accepts many changes to it and forgets them on reload."""
    return data is not None and data.library is None


def is_local(data):
    """True only for data that belongs to this file: neither linked nor an override."""
    return is_writable(data) and data.override_library is None
