# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD: highlights that follow the deformation of the surface. This module only registers."""

import importlib

_NAMES = (
    "properties",
    "evaluate",
    "setup",
    "convert",
    "show_tension",
    "versions",
    "apply_preset",
    "add_node",
    "bake",
    "command",
    "panel",
)
_registered = []


def register():
    for name in _NAMES:
        module = importlib.import_module(f".{name}", __package__)
        if hasattr(module, "register"):
            module.register()
            _registered.append(module)


def unregister():
    while _registered:
        _registered.pop().unregister()
