# SPDX-License-Identifier: Apache-2.0
"""For scripts in a child process: the groups as version 1 made them, from tests/data/version_1.

A saved file keeps such groups. Nothing here may follow a change of the add-on.
"""

import json
import math

import bpy
from blender_process import ROOT

SHADERS = ROOT / "tests" / "data" / "version_1"

GLOSSY = (
    # name, kind, default, least, most
    ("Color", "Color", (0.8, 0.8, 0.8, 1.0), None, None),
    ("Roughness", "Float", 0.5, 0.0, 1.0),
    ("Stretch", "Float", 0.0, -0.99, 0.99),
    ("Rotation", "Float", 0.0, -2 * math.pi, 2 * math.pi),
    ("Shear", "Float", 0.0, -10.0, 10.0),
    ("Tension", "Vector", (1.0, 0.0, 1.0), None, None),
    ("Tangent", "Vector", (0.0, 0.0, 0.0), None, None),
    ("Normal", "Vector", (0.0, 0.0, 0.0), None, None),
    ("Strength", "Float", 1.0, 0.0, 4.0),
    ("Height Response", "Float", 0.0, -1.0, 2.0),
)


def _group(name, inputs, outputs):
    tree = bpy.data.node_groups.new(name, "ShaderNodeTree")
    tree["ltmd_group"], tree["ltmd_version"] = name, 1
    for output, kind in outputs:
        tree.interface.new_socket(output, in_out="OUTPUT", socket_type=f"NodeSocket{kind}")
    for socket_name, kind, default, low, high in inputs:
        socket = tree.interface.new_socket(
            socket_name, in_out="INPUT", socket_type=f"NodeSocket{kind}"
        )
        socket.default_value = default
        if low is not None:
            socket.min_value, socket.max_value = low, high
    return tree, tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")


def _script(tree, shader):
    node = tree.nodes.new("ShaderNodeScript")
    text = bpy.data.texts.new(shader)
    text.write((SHADERS / f"{shader}.osl").read_text())
    engine = bpy.context.scene.render.engine
    bpy.context.scene.render.engine = "CYCLES"
    node.mode = "INTERNAL"
    node.script = text
    bpy.context.scene.render.engine = engine
    bpy.data.texts.remove(text)
    assert node.outputs and node.bytecode
    return node


def glossy():
    tree, start, end = _group("LTMD Glossy", GLOSSY, [("BSDF", "Shader")])
    script = _script(tree, "ltmd_glossy")
    for socket in start.outputs:
        if socket.name:
            tree.links.new(socket, script.inputs[socket.name.replace(" ", "")])
    tree.links.new(script.outputs["BSDF"], end.inputs["BSDF"])
    return tree


def live_tension():
    tree, start, end = _group(
        "LTMD Live Tension",
        [("UV", "Vector", (0.0, 0.0, 0.0), None, None)],
        [("Tension", "Vector"), ("Tangent", "Vector")],
    )
    script = _script(tree, "ltmd_tension_live")
    rest = tree.nodes.new("ShaderNodeAttribute")
    rest.attribute_name = "ltmd_rest"
    tree.links.new(rest.outputs["Vector"], script.inputs["Rest"])
    tree.links.new(start.outputs["UV"], script.inputs["UV"])
    for name in ("Tension", "Tangent"):
        tree.links.new(script.outputs[name], end.inputs[name])
    return tree


def set_up(obj, material):
    """The material as a version 1 set-up left it; the lobe's node and the source's are returned."""
    material.use_nodes = True
    tree = material.node_tree
    new = tree.nodes.new

    def ours(node, part):
        node["ltmd"] = part
        return node

    box = ours(new("NodeFrame"), "surface")
    old = tree.get_output_node("CYCLES")
    output = ours(new("ShaderNodeOutputMaterial"), "surface")
    output.name = output.label = "LTMD Output"
    lobe = ours(new("ShaderNodeGroup"), "surface")
    lobe.node_tree = glossy()
    lobe.name = lobe.label = "LTMD Glossy"
    diffuse = ours(new("ShaderNodeBsdfDiffuse"), "surface")
    fresnel = ours(new("ShaderNodeFresnel"), "surface")
    fresnel.inputs["IOR"].default_value = 20.0
    mix = ours(new("ShaderNodeMixShader"), "surface")
    uv = ours(new("ShaderNodeUVMap"), "source")
    tension = ours(new("ShaderNodeGroup"), "source")
    tension.node_tree = live_tension()
    tension.name = tension.label = "LTMD Live Tension"
    for node in (output, lobe, diffuse, fresnel, mix, uv, tension):
        node.parent = box
    link = tree.links.new
    link(fresnel.outputs[0], mix.inputs[0])
    link(diffuse.outputs[0], mix.inputs[1])
    link(lobe.outputs[0], mix.inputs[2])
    link(mix.outputs[0], output.inputs["Surface"])
    link(uv.outputs[0], tension.inputs["UV"])
    for name in ("Tension", "Tangent"):
        link(tension.outputs[name], lobe.inputs[name])
    old.target, output.target = "EEVEE", "CYCLES"
    output.is_active_output = True
    material.ltmd.record = json.dumps({"outputs": [[old.name, "ALL", True]], "active": ""})
    material.ltmd.set_up = 1
    rest = obj.data.attributes.new("ltmd_rest", "FLOAT_VECTOR", "POINT")
    source = obj.data.shape_keys.reference_key.points if obj.data.shape_keys else obj.data.vertices
    for value, point in zip(rest.data, source, strict=True):
        value.vector = point.co
    obj.ltmd.source = "LIVE"
    return lobe, tension
