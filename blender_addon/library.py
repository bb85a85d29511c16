# SPDX-License-Identifier: GPL-3.0-or-later
"""The compiled module `ltmd`, or in words why it is not here."""

import importlib
import sys


class LibraryMissing(Exception):
    """The measuring library is not usable in this Python; str() says what is needed."""


_module = None


def ltmd():
    """The `ltmd` module; raises LibraryMissing."""
    global _module
    if _module is None:
        try:
            _module = importlib.import_module("ltmd")
        except ImportError as error:
            # A zip whose wheels do not fit this Python is enabled without a word by Blender.
            version = f"{sys.version_info.major}.{sys.version_info.minor}"
            raise LibraryMissing(
                "Baking needs the ltmd library, which this installation does not have for "
                f"Python {version} on {sys.platform}: install the LTMD extension built for this "
                f"Blender and system ({error})"
            ) from None
    return _module


def problem():
    """None if the library is usable, else a sentence."""
    try:
        ltmd()
    except LibraryMissing as error:
        return str(error)
    return None
