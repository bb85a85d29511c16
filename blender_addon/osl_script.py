# SPDX-License-Identifier: GPL-3.0-or-later
"""Script nodes that carry their compiled shader: no path, no text data-block, no compiler needed.

The shaders are in `osl/` beside this file in the released extension, beside the add-on's folder in
a source tree.
"""

import importlib.util
from pathlib import Path

import bpy

from .osl_inline import inlined


def folder():
    """Where the .osl files are."""
    here = Path(__file__).resolve().parent
    shipped = here / "osl"
    return shipped if shipped.is_dir() else here.parent / "osl"


def fill(node, name, scene=None):
    """Compile shader `name` into a Script node. Raises RuntimeError if that fails."""
    scene = scene or bpy.context.scene
    if importlib.util.find_spec("oslquery") is None:
        # Blender as a module hides it; without it the node gets no sockets.
        expose = getattr(bpy.utils, "expose_bundled_modules", None)
        if expose:
            expose()
    text = bpy.data.texts.new(f"{name}.osl")
    engine = scene.render.engine
    try:
        text.write(inlined(folder() / f"{name}.osl"))
        # The node is compiled by the scene's engine at the moment the script is assigned.
        if engine != "CYCLES":
            scene.render.engine = "CYCLES"
        node.mode = "INTERNAL"
        node.script = text
    finally:
        if scene.render.engine != engine:
            scene.render.engine = engine
        bpy.data.texts.remove(text)  # the bytecode stays in the node
    if not node.outputs or not node.bytecode:
        raise RuntimeError(
            f"The shader {name} could not be compiled: this Blender may be built without Open "
            "Shading Language (details are on the console)"
        )
    return node
