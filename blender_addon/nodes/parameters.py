# SPDX-License-Identifier: GPL-3.0-or-later
"""LTMD Parameters: the deformed highlight as numbers, for any other node."""

from .. import osl_script
from . import add_output, ends, link_script
from .material_inputs import add_roughness_inputs, add_surface_inputs
from .node_math import Scalar, Vector, arrange

NAME = "LTMD Parameters"
VERSION = 1

# Group socket -> shader parameter, where it is not the name without spaces: a shader may not have
# an input and an output of one name.
OUTPUTS = {"Roughness": "OutRoughness", "Tangent": "Direction"}


def add_parameter_outputs(tree):
    add_output(
        tree,
        "Roughness",
        "Float",
        "Mean roughness of the deformed highlight, for Principled, Glossy or Metallic BSDF",
    )
    add_output(
        tree, "Anisotropy", "Float", "For the Glossy BSDF; link Tangent to its Tangent as well"
    )
    add_output(
        tree,
        "Anisotropic",
        "Float",
        "For the Principled or Metallic BSDF; link Principled Tangent to its Tangent as well. "
        "Highlights can be up to ten times as long as wide there",
    )
    add_output(tree, "Tangent", "Vector", "Direction in which the surface is smoother")
    add_output(tree, "Principled Tangent", "Vector", "Direction in which the surface is rougher")
    add_output(tree, "Alpha X", "Float", "Exact alpha along Tangent; may exceed 1")
    add_output(tree, "Alpha Y", "Float", "Exact alpha across Tangent; may exceed 1")
    add_output(
        tree,
        "Alpha Squared",
        "Vector",
        "xx, xy and yy of the matrix of squared alphas, X along the UV map's U",
    )


def build(tree):
    add_parameter_outputs(tree)
    add_roughness_inputs(tree)
    add_surface_inputs(tree)
    start, end = ends(tree, 400)
    script = osl_script.fill(tree.nodes.new("ShaderNodeScript"), "ltmd_parameters")
    link_script(tree, start, script)
    for socket in end.inputs:
        if socket.name:
            name = OUTPUTS.get(socket.name, socket.name.replace(" ", ""))
            tree.links.new(script.outputs[name], socket)
    # Where scripts do not run their outputs are 0: there the roughness at rest is shown.
    direction = Vector(tree, script.outputs["Direction"])
    runs = direction.dot(direction) > 0.5
    at_rest = Scalar(tree, start.outputs["Roughness"])
    roughness = runs.choose(Scalar(tree, script.outputs["OutRoughness"]), at_rest)
    roughness.feed(end.inputs["Roughness"])
    arrange(tree)
