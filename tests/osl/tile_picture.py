# SPDX-License-Identifier: Apache-2.0
"""Render tiles (see tiles.py) of a node group in a child, and judge their means."""

import numpy as np
from blender_process import ROOT, run

_RENDER = (
    f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from importlib import import_module
from shading import *
import tiles
"""
    + """
def rendered(module, views, samples, attributes, constants):
    tree, output = tiles.scene(views, samples, attributes)
    node = group(tree, import_module("blender_addon.nodes." + module))
    for name, value in constants.items():
        node.inputs[name].default_value = value
    for name in attributes:
        tiles.link_attribute(tree, name, node.inputs[name])
    tiles.link_attribute(tree, "x_axis", node.inputs["Tangent"])
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return tiles.measure(len(views))
mean, error = rendered(**ARGUMENTS)
report(mean=mean, error=error)
"""
)
WHITE = (1, 1, 1, 1)


def tile_means(module, views, samples, attributes, **constants):
    """Mean and standard error, [n, 3] each, of tiles seen from `views` in their own frames.

    module: of the node group in blender_addon.nodes. attributes: inputs with a value per tile,
    those of whole numbers plus a half. constants: the other inputs.
    """
    arguments = {
        "module": module,
        "views": np.asarray(views).tolist(),
        "samples": samples,
        "attributes": {name: np.asarray(v).tolist() for name, v in attributes.items()},
        "constants": {"Roughness Is Alpha": True, **constants},
    }
    result = run(_RENDER, arguments=arguments)
    return np.array(result["mean"]), np.array(result["error"])


def check(mean, error, expected, names, tolerance):
    """No more deviation than chance has: each below 4.5 sigma, and their mean square near 1.

    tolerance: relative, of what the shader computes by a fit.
    """
    z = (mean - expected) / np.hypot(error, tolerance * np.maximum(1, expected))
    worst = np.unravel_index(np.argmax(np.abs(z)), z.shape)
    where = (names[worst[0]], mean[worst], expected[worst], error[worst])
    assert np.abs(z).max() < 4.5, where
    assert np.mean(z**2) < 1.5
